#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "job_queue_fixture.h"
#include "supple/base/best_so_far.h"
#include "supple/base/memory_account.h"
#include "supple/budget/counting_malloc.h"

namespace supple::jobs {
namespace {

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

TEST_F(JobQueueTest, StopsASupersededComputationWithinMilliseconds) {
  const auto in_session = [](Computation computation) {
    computation.session = "drag";
    computation.priority = Priority::interactive;
    return computation;
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

}  // namespace
}  // namespace supple::jobs
