#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "job_queue_fixture.h"
#include "supple/base/background_threads.h"

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

TEST_F(JobQueueTest, RemovesAFinishedJob) {
  const auto id = queue().submit(answering("x")).record.id;
  wait_until_finished(id);
  EXPECT_FALSE(queue().remove(id));
  EXPECT_EQ(code_of([&] { queue().status(id); }), "job.not_found");
  EXPECT_EQ(code_of([&] { queue().remove(id); }), "job.not_found");
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

}  // namespace
}  // namespace supple::jobs
