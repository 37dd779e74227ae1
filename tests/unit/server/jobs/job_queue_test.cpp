#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "job_queue_fixture.h"
#include "supple/base/background_threads.h"
#include "supple/base/best_so_far.h"
#include "supple/base/memory_account.h"
#include "supple/budget/counting_malloc.h"

namespace supple::jobs {
namespace {

TEST_F(JobQueueTest, RunsAJobAndKeepsItsResult) {
  const auto id = queue().submit(answering("42")).record.id;
  const auto status = wait_until_finished(id);
  EXPECT_EQ(status.record.state, JobState::successful);
  EXPECT_EQ(status.progress, 1);
  EXPECT_GE(status.record.started, status.record.created);
  EXPECT_EQ(queue().result(id).body.text(), "42");
}

TEST_F(JobQueueTest, KeepsTheProblemOfAFailedJob) {
  const auto id =
      queue()
          .submit(computation([](const Execution&) -> store::Result { throw Error("karcher.weights", "Bad."); }))
          .record.id;
  const auto status = wait_until_finished(id);
  EXPECT_EQ(status.record.state, JobState::failed);
  EXPECT_EQ(status.record.error_status, 422);
  EXPECT_NE(status.record.error.find("karcher.weights"), std::string::npos);
}

TEST_F(JobQueueTest, StopsAJobThatIsCancelled) {
  const auto id = queue().submit(endless()).record.id;
  wait_until_started();
  EXPECT_EQ(code_of([&] { queue().result(id); }), "job.not_finished");
  const auto dismissed = queue().remove(id);
  ASSERT_TRUE(dismissed);
  EXPECT_EQ(dismissed->record.state, JobState::dismissed);
  EXPECT_EQ(code_of([&] { queue().result(id); }), "job.dismissed");
  EXPECT_EQ(wait_until_finished(queue().submit(answering("next")).record.id).record.state, JobState::successful)
      << "its worker is free again";
}

TEST_F(JobQueueTest, RemovesAFinishedJob) {
  const auto id = queue().submit(answering("x")).record.id;
  wait_until_finished(id);
  EXPECT_FALSE(queue().remove(id));
  EXPECT_EQ(code_of([&] { queue().status(id); }), "job.not_found");
  EXPECT_EQ(code_of([&] { queue().remove(id); }), "job.not_found");
}

TEST_F(JobQueueTest, ReplacesWhatStillRunsInTheSameSession) {
  const auto in_session = [](Computation computation, const std::string& session) {
    computation.session = session;
    return computation;
  };
  const auto job = queue().submit(in_session(endless(), "a")).record.id;
  wait_until_started();
  std::string immediate;
  std::thread caller([&] { immediate = code_of([&] { queue().run_now(in_session(endless(), "b"), {}); }); });
  wait_until_started(2);
  EXPECT_EQ(queue().run_now(in_session(answering("c"), "c"), {}).body, "c") << "other sessions are left alone";
  EXPECT_EQ(queue().run_now(in_session(answering("new"), "b"), {}).body, "new");
  caller.join();
  EXPECT_EQ(immediate, "design.superseded");
  EXPECT_EQ(queue().status(job).record.state, JobState::running);
  EXPECT_EQ(queue().run_now(in_session(answering("newer"), "a"), {}).body, "newer");
  const auto status = wait_until_finished(job);
  EXPECT_EQ(status.record.state, JobState::failed);
  EXPECT_EQ(status.record.error_status, 409);
  EXPECT_EQ(queue().run_now(in_session(answering("alone"), "a"), {}).body, "alone") << "nothing is left to replace";
}

TEST_F(JobQueueTest, ShowsWhatARunningJobHasPublished) {
  std::atomic<bool> go_on{false};
  const auto id = queue()
                      .submit(computation([&](const Execution& execution) {
                        execution.progress->publish("{\"step\":1}");
                        execution.progress->publish("{\"step\":2}");
                        while (!go_on) execution.checkpoint(0.5, "waiting");
                        return store::Result{"text/plain", {}, "done"};
                      }))
                      .record.id;
  for (int i = 0; i < 1000 && queue().status(id).partial != "{\"step\":2}"; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(queue().status(id).partial, "{\"step\":2}");
  go_on = true;
  wait_until_finished(id);
}

TEST_F(JobQueueTest, FailsARunningJobAtItsDeadline) {
  const auto id = queue().submit(endless(0.05)).record.id;
  const auto status = wait_until_finished(id);
  EXPECT_EQ(status.record.error_status, 504);
  EXPECT_NE(status.record.error.find("job.deadline_exceeded"), std::string::npos);
}

/// Reports a block to the thread's account where malloc does not, as with a sanitizer.
void report_block(std::size_t bytes) {
  if (budget::counts_allocations()) return;
  if (!may_allocate(bytes)) throw std::bad_alloc();
  note_block(static_cast<std::int64_t>(bytes));
}

/// Takes so much memory in small blocks that it has to be stopped, and checks for a stop request meanwhile.
store::Result fill(const Execution& execution, std::size_t bytes) {
  constexpr std::size_t block = 1 << 16;
  std::vector<std::vector<char>> blocks;
  for (std::size_t taken = 0; taken < bytes; taken += block) {
    execution.checkpoint(0.5, "filling");
    report_block(block);
    blocks.emplace_back(block, 'x');
  }
  return {"text/plain", {}, std::to_string(blocks.size())};
}

TEST_F(JobQueueTest, StopsWhatTakesMoreMemoryThanARequestMay) {
  options_.memory = &memory_;
  const auto filling = [](std::size_t bytes) {
    return computation([bytes](const Execution& execution) { return fill(execution, bytes); });
  };
  const auto in_one_block = computation([](const Execution&) {
    constexpr auto bytes = std::size_t{65} << 20;
    report_block(bytes);
    return store::Result{"text/plain", {}, std::string(bytes, 'x')};
  });
  EXPECT_EQ(queue().run_now(filling(32 << 20), {}).body, "512");
  EXPECT_EQ(code_of([&] { queue().run_now(filling(80 << 20), {}); }), "request.too_much_memory");
  EXPECT_EQ(code_of([&] { queue().run_now(in_one_block, {}); }), "request.too_much_memory");
  const auto job = wait_until_finished(queue().submit(filling(80 << 20)).record.id);
  EXPECT_EQ(job.record.state, JobState::failed);
  EXPECT_NE(job.record.error.find("--max-request-memory"), std::string::npos) << job.record.error;
  EXPECT_LT(memory_.used(), 1 << 20);
}

/// Searches until it is stopped, then reports that, without an end if `ends` is false.
store::Result search_and_report(const Execution& execution, bool ends) {
  const StopReason reason = search_until_stopped(
      execution.cancellation, [] { return true; },
      [&] {
        while (true) execution.checkpoint(0.5, "searching");
      });
  while (!ends) execution.checkpoint(1, "reporting");
  return {"text/plain", {}, reason == StopReason::deadline ? "deadline" : "another reason"};
}

TEST_F(JobQueueTest, LetsASearchReportItsBestAfterItsDeadline) {
  // The time begins before the job is stored, which takes long on a busy machine.
  const auto search = computation([](const Execution& execution) { return search_and_report(execution, true); }, 1);
  const auto id = queue().submit(search).record.id;
  EXPECT_EQ(wait_until_finished(id).record.state, JobState::successful);
  EXPECT_EQ(queue().result(id).body.text(), "deadline");
  EXPECT_EQ(queue().run_now(search, {}).body, "deadline");
}

TEST_F(JobQueueTest, StopsAReportThatTakesTooLong) {
  const auto search = computation([](const Execution& execution) { return search_and_report(execution, false); }, 0.03);
  EXPECT_EQ(code_of([&] { queue().run_now(search, {}); }), "job.deadline_exceeded");
  const auto status = wait_until_finished(queue().submit(search).record.id);
  EXPECT_EQ(status.record.error_status, 504);
}

TEST_F(JobQueueTest, StopsAReportWhoseJobIsCancelled) {
  std::atomic<bool> reports{false};
  const auto search = computation(
      [&](const Execution& execution) -> store::Result {
        try {
          while (true) execution.checkpoint(0.5, "searching");
        } catch (const Cancelled& stop) {
          if (!execution.cancellation.resume(stop.reason())) throw;
        }
        reports = true;
        while (true) execution.checkpoint(1, "reporting");
      },
      0.03);
  EXPECT_EQ(code_of([&] { queue().run_now(search, {.hung_up = [&] { return reports.load(); }}); }), "job.cancelled");
}

TEST_F(JobQueueTest, LetsASearchReportItsBestWhereItReachesTheLimitOfMemory) {
  options_.memory = &memory_;
  const auto search = computation([](const Execution& execution) -> store::Result {
    const StopReason reason = search_until_stopped(
        execution.cancellation, [] { return true; }, [&] { fill(execution, 80 << 20); });
    execution.checkpoint(1, "reporting");
    return {"text/plain", {}, reason == StopReason::memory ? "memory" : "another reason"};
  });
  EXPECT_EQ(queue().run_now(search, {}).body, "memory");
}

TEST_F(JobQueueTest, StopsAReportThatTakesMoreMemoryThanItsReserve) {
  options_.memory = &memory_;
  const auto reporting = [](const std::function<store::Result(const Execution&)>& report) {
    return computation([report](const Execution& execution) {
      search_until_stopped(
          execution.cancellation, [] { return true; }, [&] { fill(execution, 80 << 20); });
      return report(execution);
    });
  };
  const auto greedy = reporting([](const Execution& execution) { return fill(execution, 80 << 20); });
  EXPECT_EQ(code_of([&] { queue().run_now(greedy, {}); }), "request.too_much_memory");
  const auto cancelled = reporting([](const Execution& execution) -> store::Result {
    execution.cancellation.request(StopReason::cancelled);
    execution.checkpoint(1, "reporting");
    return {};
  });
  EXPECT_EQ(code_of([&] { queue().run_now(cancelled, {}); }), "job.cancelled");
  EXPECT_LT(memory_.used(), 1 << 20);
}

TEST_F(JobQueueTest, FailsAWaitingJobAtItsDeadline) {
  const auto first = queue().submit(endless()).record.id;
  wait_until_started();
  const auto second = queue().submit(endless(0.05)).record.id;
  EXPECT_EQ(wait_until_finished(second).record.state, JobState::failed);
  EXPECT_EQ(started_, 1) << "it never ran";
  queue().remove(first);
}

TEST_F(JobQueueTest, RefusesMoreJobsThanTheQueueHoldsAndNamesTheLimit) {
  options_.max_queue = 2;
  queue().submit(endless());
  wait_until_started();
  queue().submit(answering("a"));
  queue().submit(answering("b"));
  try {
    queue().submit(answering("c"));
    FAIL() << "nothing was thrown";
  } catch (const problem::ProblemError& error) {
    EXPECT_EQ(error.code(), "job.queue_full");
    EXPECT_EQ(error.problem().limit->limit, 2);
    EXPECT_EQ(error.problem().limit->setting, "--max-queue");
  }
}

TEST_F(JobQueueTest, RefusesMoreWaitingJobsThanAClientMayHaveAndNotThoseOfOthers) {
  const auto of = [](const std::string& client) {
    auto computation = answering("x");
    computation.client = client;
    computation.max_waiting = 2;
    return computation;
  };
  const auto running = queue().submit(endless()).record.id;
  wait_until_started();
  queue().submit(of("a"));
  const auto last = queue().submit(of("a")).record.id;
  try {
    queue().submit(of("a"));
    FAIL() << "nothing was thrown";
  } catch (const problem::ProblemError& error) {
    EXPECT_EQ(error.code(), "job.client_queue_full");
    EXPECT_EQ(error.problem().limit->limit, 2);
    EXPECT_GE(error.problem().retry_after.value_or(0), 1);
  }
  queue().submit(of("b"));
  queue().remove(running);
  wait_until_finished(last);
  EXPECT_EQ(code_of([&] { queue().submit(of("a")); }), "nothing was thrown");
}

TEST_F(JobQueueTest, RefusesJobsThatHoldMoreMemoryThanTheQueueMay) {
  options_.max_queue_bytes = 100;
  const auto of_bytes = [](std::int64_t bytes) {
    auto computation = answering("x");
    computation.bytes = bytes;
    return computation;
  };
  const auto running = queue().submit(endless()).record.id;
  wait_until_started();
  const auto first = queue().submit(of_bytes(60)).record.id;
  try {
    queue().submit(of_bytes(41));
    FAIL() << "nothing was thrown";
  } catch (const problem::ProblemError& error) {
    EXPECT_EQ(error.code(), "job.queue_full");
    EXPECT_EQ(error.problem().limit->limit, 100);
    EXPECT_EQ(error.problem().limit->value, 101);
    EXPECT_EQ(error.problem().limit->setting, "--max-queue-bytes");
    EXPECT_GE(error.problem().retry_after.value_or(0), 1);
  }
  const auto second = queue().submit(of_bytes(40)).record.id;
  queue().remove(first);
  queue().remove(running);
  wait_until_finished(second);
  // A job that leaves the queue makes place, whether it was dismissed or has run.
  for (int i = 0; i < 3; ++i) wait_until_finished(queue().submit(of_bytes(100)).record.id);
}

TEST_F(JobQueueTest, LetsNoClientKeepTheWorkersFromOthers) {
  std::mutex mutex;
  std::string order;
  const auto of_client = [&](const std::string& client) {
    Computation computation{"test", {}, 600, {}};
    computation.client = client;
    computation.run = [&, client](const Execution&) {
      const std::lock_guard lock(mutex);
      order += client;
      return store::Result{"text/plain", {}, client};
    };
    return computation;
  };
  options_.workers = 2;
  auto long_one = endless();
  long_one.client = "a";
  const auto running = queue().submit(long_one).record.id;
  wait_until_started();
  auto blocker = endless();
  blocker.client = "b";
  const auto blocked = queue().submit(blocker).record.id;
  while (started_ < 2) std::this_thread::yield();
  std::vector<std::string> others;
  for (int i = 0; i < 5; ++i) others.push_back(queue().submit(of_client("a")).record.id);
  const auto of_other = queue().submit(of_client("c")).record.id;
  queue().remove(blocked);  // "c" is next, since "a" has a running job and "c" has none
  wait_until_finished(of_other);
  {
    const std::lock_guard lock(mutex);
    EXPECT_EQ(order.substr(0, 1), "c");
  }
  queue().remove(running);
  for (const auto& id : others) wait_until_finished(id);
}

/// The computation with this priority.
Computation prioritized(Computation computation, Priority priority) {
  computation.priority = priority;
  return computation;
}

TEST_F(JobQueueTest, ComputesInTheBackgroundWithoutDelayingOthers) {
  std::vector<std::string> in_background;
  for (int i = 0; i < 3; ++i)
    in_background.push_back(queue().submit(prioritized(endless(), Priority::background)).record.id);
  wait_until_started();
  EXPECT_EQ(queue().run_within(prioritized(answering("drag"), Priority::interactive), 60, {}).result->body, "drag");
  EXPECT_EQ(queue().run_within(answering("normal"), 60, {}).result->body, "normal");
  EXPECT_EQ(queue().run_now(answering("now"), {}).body, "now");
  EXPECT_EQ(started_, 1) << "there is one worker in the background";
  EXPECT_EQ(queue().waiting(Priority::background), 2U);
  const auto normal = queue().submit(endless()).record.id;
  wait_until_started(2);
  EXPECT_EQ(queue().run_within(prioritized(answering("drag"), Priority::interactive), 60, {}).result->body, "drag")
      << "nor do normal jobs delay it";
  in_background.push_back(normal);
  for (const auto& id : in_background) queue().remove(id);
}

TEST_F(JobQueueTest, AnswersInTheBackgroundOnThreadsWithALowerPriority) {
  const auto niceness = [] { return ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid())); };
  const auto asking = [&] {
    return computation([&](const Execution&) {
      const bool is_background = is_background_thread();
      return store::Result{"text/plain", {}, std::to_string(niceness()) + (is_background ? " in the background" : "")};
    });
  };
  EXPECT_EQ(queue().run_now(asking(), {}).body, std::to_string(niceness()));
  const auto nicer = std::to_string(std::min(19, niceness() + 10)) + " in the background";
  Profile profile;
  EXPECT_EQ(queue().run_now(prioritized(asking(), Priority::background), {}, &profile).body, nicer);
  EXPECT_GT(profile.computed, 0);
  EXPECT_EQ(code_of([&] { queue().run_now(prioritized(endless(0.05), Priority::background), {}); }),
            "job.deadline_exceeded");
  EXPECT_EQ(queue().run_now(asking(), {}).body, std::to_string(niceness())) << "other threads are as they were";
}

TEST_F(JobQueueTest, StopsASupersededComputationWithinMilliseconds) {
  const auto in_session = [](Computation computation) {
    computation.session = "drag";
    return prioritized(std::move(computation), Priority::interactive);
  };
  std::chrono::steady_clock::time_point stopped;
  const auto noting = in_session(computation([&](const Execution& execution) -> store::Result {
    ++started_;
    while (!execution.cancellation.requested()) std::this_thread::yield();
    stopped = std::chrono::steady_clock::now();
    execution.cancellation.throw_if_requested();
    return {};
  }));
  std::string code;
  std::thread caller([&] { code = code_of([&] { queue().run_within(noting, 60, {}); }); });
  wait_until_started();
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(queue().run_within(in_session(answering("new")), 60, {}).result->body, "new");
  caller.join();
  EXPECT_EQ(code, "design.superseded");
  EXPECT_LT(stopped - begin, std::chrono::seconds(1)) << "the request stops it, and no thread that looks now and then";
}

TEST_F(JobQueueTest, KeepsThePriorityOfAJobForTheNextProcess) {
  remake_ = echo;
  const auto id = queue().submit(prioritized(endless(), Priority::background), request("body")).record.id;
  wait_until_started();
  EXPECT_EQ(queue().status(id).record.priority, Priority::background);
  restart();
  const auto status = wait_until_finished(id);
  EXPECT_EQ(status.record.priority, Priority::background);
  EXPECT_EQ(status.record.state, JobState::successful);
}

TEST_F(JobQueueTest, TellsProgressAndStage) {
  const auto id = queue().submit(endless()).record.id;
  std::uint64_t version = 0;
  JobStatus status;
  for (int i = 0; i < 100 && status.progress == 0; ++i) status = queue().wait_for_change(id, version, 0.1);
  EXPECT_EQ(status.progress, 0.5);
  EXPECT_EQ(status.stage, "spinning");
  EXPECT_EQ(status.record.state, JobState::running);
  queue().remove(id);
}

TEST_F(JobQueueTest, ListsByState) {
  const auto done = queue().submit(answering("x")).record.id;
  wait_until_finished(done);
  const auto running = queue().submit(endless()).record.id;
  wait_until_started();
  const auto waiting = queue().submit(answering("y")).record.id;
  const auto ids = [&](std::optional<JobState> state) {
    std::vector<std::string> result;
    for (const auto& status : queue().list(state, 10, "")) result.push_back(status.record.id);
    return result;
  };
  using Ids = std::vector<std::string>;
  EXPECT_EQ(ids({}), (Ids{waiting, running, done}));
  EXPECT_EQ(ids(JobState::accepted), Ids{waiting});
  EXPECT_EQ(ids(JobState::running), Ids{running});
  EXPECT_EQ(ids(JobState::successful), Ids{done});
  EXPECT_TRUE(queue().mesh_in_use("mesh"));
  queue().remove(running);
  wait_until_finished(waiting);
  const auto waited_for = queue().run_within(endless(), 0.1, {}).job.record.id;
  EXPECT_EQ(ids(JobState::running), Ids{waited_for}) << "also one that a client has waited for";
}

TEST_F(JobQueueTest, ComputesImmediatelyWithoutATraceInTheStore) {
  EXPECT_EQ(queue().run_now(answering("now"), {}).body, "now");
  EXPECT_TRUE(store_->jobs().jobs({}, 10, "").empty());
}

TEST_F(JobQueueTest, CancelsAnImmediateComputationWhoseClientHangsUp) {
  std::atomic<bool> gone{false};
  std::thread client([&] {
    wait_until_started();
    gone = true;
  });
  EXPECT_EQ(code_of([&] { queue().run_now(endless(), {[&] { return gone.load(); }}); }), "job.cancelled");
  client.join();
  EXPECT_EQ(queue().immediate(), 0);
}

TEST_F(JobQueueTest, StopsAnImmediateComputationAtItsDeadline) {
  EXPECT_EQ(code_of([&] { queue().run_now(endless(0.03), {}); }), "job.deadline_exceeded");
}

TEST_F(JobQueueTest, AnswersWithinTheWaitOrMakesAJob) {
  const auto quick = queue().run_within(answering("quick"), 30, {});
  ASSERT_TRUE(quick.result);
  EXPECT_EQ(quick.result->body, "quick");
  EXPECT_TRUE(store_->jobs().jobs({}, 10, "").empty()) << "an answer in time leaves no job";
  const auto slow = queue().run_within(endless(), 0.05, {});
  EXPECT_FALSE(slow.result);
  EXPECT_EQ(queue().status(slow.job.record.id).record.state, JobState::running);
  queue().remove(slow.job.record.id);
}

TEST_F(JobQueueTest, ThrowsWhatAComputationWithinTheWaitThrows) {
  const auto failing = [](const Execution&) -> store::Result { throw Error("karcher.weights", "Bad."); };
  EXPECT_EQ(code_of([&] { queue().run_within(computation(failing), 30, {}); }), "karcher.weights");
  EXPECT_EQ(code_of([&] { queue().run_within(endless(), 30, [&] { return started_ > 0; }); }), "job.cancelled");
}

TEST_F(JobQueueTest, ThrowsWhatWasThrownWhenAComputationWithinTheWaitWasToEnd) {
  queue_ = std::make_unique<JobQueue>(
      *store_, options_, [](const problem::Problem&) -> std::string { throw std::runtime_error("no text"); },
      [](const store::JobRecord&) {});
  const auto failing = [](const Execution&) -> store::Result { throw Error("karcher.weights", "Bad."); };
  EXPECT_EQ(code_of([&] { queue().run_within(computation(failing), 30, {}); }), "server.internal");
  EXPECT_TRUE(queue().run_within(answering("x"), 30, {}).result) << "the worker goes on";
}

TEST_F(JobQueueTest, GoesOnWithOtherJobsWhateverIsThrownAtTheEndOfOne) {
  std::mutex mutex;
  std::vector<std::string> lines;
  queue_ = std::make_unique<JobQueue>(
      *store_, options_, json::write_problem,
      [](const store::JobRecord&) { throw std::runtime_error("the observer fails"); },
      [&](const std::string& line) {
        const std::lock_guard lock(mutex);
        lines.push_back(line);
      });
  for (const char* body : {"a", "b"})
    EXPECT_EQ(wait_until_finished(queue().submit(answering(body)).record.id).record.state, JobState::successful);
  std::vector<std::string> ids{queue().submit(endless()).record.id};
  wait_until_started();
  for (const char* body : {"c", "d"}) ids.push_back(queue().submit(answering(body)).record.id);
  queue().shut_down(0);
  for (const auto& id : ids) EXPECT_NE(store_->jobs().job(id)->error.find("job.interrupted"), std::string::npos);
  queue_.reset();
  EXPECT_EQ(lines.size(), 5U) << "one for each job";
  for (const auto& line : lines) EXPECT_NE(line.find("the observer fails"), std::string::npos) << line;
}

TEST_F(JobQueueTest, CallsJobsOfAnEarlierProcessInterrupted) {
  store::JobRecord job;
  job.id = "lost";
  store_->jobs().add_job(job);
  const auto status = queue().status("lost");
  EXPECT_EQ(status.record.state, JobState::failed);
  EXPECT_NE(status.record.error.find("job.interrupted"), std::string::npos);
}

TEST_F(JobQueueTest, GoesOnWithTheJobsOfAProcessThatWasToldToEnd) {
  remake_ = echo;
  const auto running = queue().submit(endless(), request("running")).record;
  wait_until_started();
  std::vector<std::string> ids{running.id};
  for (const char* body : {"a", "b", "c"}) {
    auto waiting = answering("of the first process");
    waiting.client = body;
    waiting.session = body;
    ids.push_back(queue().submit(std::move(waiting), request(body)).record.id);
  }
  const auto begun = queue().status(running.id).record;
  EXPECT_EQ(begun.state, JobState::running);
  EXPECT_EQ(begun.attempts, 1);
  queue().shut_down(0.02);
  const auto left = store_->jobs().unfinished_jobs();
  ASSERT_EQ(left.size(), 4U);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    EXPECT_EQ(left[i].id, ids[i]);
    EXPECT_EQ(left[i].state, JobState::accepted);
    EXPECT_EQ(left[i].attempts, 0) << "an end in good order is no failed attempt";
  }
  restart();
  std::int64_t last = 0;
  for (const auto& [id, body] : std::vector<std::pair<std::string, std::string>>{
           {ids[0], "running"}, {ids[1], "a"}, {ids[2], "b"}, {ids[3], "c"}}) {
    const auto record = wait_until_finished(id).record;
    EXPECT_EQ(record.state, JobState::successful) << record.error;
    EXPECT_EQ(queue().result(id).body.text(), body);
    EXPECT_GE(record.started, last) << "in the old order";
    EXPECT_EQ(record.client, store_->jobs().job(id)->client);
    last = record.started;
  }
  EXPECT_EQ(store_->jobs().job(ids[1])->client, "a");
  EXPECT_EQ(store_->jobs().job(ids[1])->session, "a");
  EXPECT_TRUE(fs::is_empty(folder_ / "requests"));
}

TEST_F(JobQueueTest, TellsOfAJobInTheQueueWhatItsRequestDoesWrongNow) {
  remake_ = [](const store::JobRecord&, const store::StoredRequest&, const Execution&) -> Computation {
    throw Error("model.not_found", "It has gone.");
  };
  leave_running("j", 1, "x");
  const auto record = wait_until_finished("j").record;
  EXPECT_EQ(record.error_status, 404);
  EXPECT_NE(record.error.find("model.not_found"), std::string::npos);
}

TEST_F(JobQueueTest, LeavesNoJobToTheNextProcessForWhatItsComputationThrows) {
  remake_ = echo;
  const auto failing = [](const Execution&) -> store::Result { throw Error("server.shutting_down", "Not this one."); };
  const auto id = queue().submit(computation(failing), request("x")).record.id;
  const auto record = wait_until_finished(id).record;
  EXPECT_EQ(record.state, JobState::failed);
  EXPECT_EQ(record.error_status, 503);
}

TEST_F(JobQueueTest, GivesAJobUpThatTheProcessEndedInTooOften) {
  remake_ = echo;
  leave_running("twice", 2, "twice");
  leave_running("thrice", 3, "thrice");
  EXPECT_EQ(wait_until_finished("twice").record.state, JobState::successful);
  EXPECT_EQ(store_->jobs().job("twice")->attempts, 3);
  const auto record = queue().status("thrice").record;
  EXPECT_EQ(record.state, JobState::failed);
  EXPECT_NE(record.error.find("job.given_up"), std::string::npos);
  EXPECT_NE(record.error.find("ended 3 times"), std::string::npos);
  EXPECT_FALSE(store_->blobs().has_request("thrice"));
}

TEST_F(JobQueueTest, NotesInTheStoreThatAJobBegins) {
  const auto waited = queue().run_within(endless(), 0.1, {});
  ASSERT_FALSE(waited.result);
  EXPECT_EQ(store_->jobs().job(waited.job.record.id)->state, JobState::running);
  queue().remove(waited.job.record.id);
  const auto id = queue().submit(endless()).record.id;
  wait_until_started(2);
  const auto record = *store_->jobs().job(id);
  EXPECT_EQ(record.state, JobState::running);
  EXPECT_EQ(record.attempts, 1);
  EXPECT_GT(record.started, 0);
}

TEST_F(JobQueueTest, RunsLastAttemptsOneAtATimeBesideOthers) {
  options_.workers = 3;
  std::atomic<int> suspects{0};
  std::atomic<int> most{0};
  std::atomic<int> others{0};
  remake_ = [&](const store::JobRecord& record, const store::StoredRequest&, const Execution&) {
    auto& running = record.attempts == 2 ? suspects : others;
    return computation([&](const Execution&) {
      const int now = ++running;
      if (&running == &suspects && now > most) most = now;
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
      --running;
      return store::Result{"text/plain", {}, "x"};
    });
  };
  for (const char* id : {"a", "b", "c"}) leave_running(id, 2, "x");
  leave_running("d", 1, "x");
  for (const char* id : {"a", "b", "c", "d"})
    EXPECT_EQ(wait_until_finished(id).record.state, JobState::successful) << id;
  EXPECT_EQ(most, 1);
}

TEST_F(JobQueueTest, KeepsNoRequestOfWhatNeverBecameAJob) {
  options_.max_queue = 0;
  EXPECT_EQ(code_of([&] { queue().submit(answering("x"), request("x")); }), "job.queue_full");
  options_.max_queue = 10;
  queue_.reset();
  EXPECT_TRUE(queue().run_within(answering("x"), 30, {}, request("x")).result);
  EXPECT_TRUE(fs::is_empty(folder_ / "requests"));
  EXPECT_TRUE(store_->jobs().jobs({}, 10, "").empty());
}

TEST_F(JobQueueTest, KeepsTheDismissalOfAJobThatEndsWithTheProcess) {
  remake_ = echo;
  const auto id = queue().submit(endless(), request("x")).record.id;
  wait_until_started();
  queue().remove(id);
  restart();
  EXPECT_EQ(queue().status(id).record.state, JobState::dismissed);
}

TEST_F(JobQueueTest, LetsRunningJobsFinishWithinTheGrace) {
  const auto id = queue()
                      .submit(computation([this](const Execution&) {
                        ++started_;
                        std::this_thread::sleep_for(std::chrono::milliseconds(50));
                        return store::Result{"text/plain", {}, "late"};
                      }))
                      .record.id;
  wait_until_started();
  queue().shut_down(30);
  EXPECT_EQ(store_->blobs().job_result(id).body.text(), "late");
}

TEST_F(JobQueueTest, InterruptsWhatDoesNotFinishWithinTheGrace) {
  const auto running = queue().submit(endless()).record.id;
  wait_until_started();
  const auto waiting = queue().submit(answering("x")).record.id;
  queue().shut_down(0.02);
  for (const auto& id : {running, waiting}) {
    EXPECT_NE(store_->jobs().job(id)->error.find("job.interrupted"), std::string::npos);
  }
  EXPECT_EQ(code_of([&] { queue().submit(answering("x")); }), "server.shutting_down");
  EXPECT_EQ(code_of([&] { queue().run_now(answering("x"), {}); }), "server.shutting_down");
}

}  // namespace
}  // namespace supple::jobs
