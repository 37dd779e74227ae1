#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "job_queue_fixture.h"
#include "supple/json/answers.h"
#include "supple/log/context.h"
#include "supple/problem/problem.h"
#include "unit/server/held_computation.h"

namespace supple::jobs {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr double short_deadline = 0.05;  // seconds
constexpr auto patience = 100s;          // time that a test waits for what has to happen

/// Tests of immediate computations that do not check for a stop request, and of their callers.
class AbandonmentTest : public JobTest {
 protected:
  AbandonmentTest() { options_.immediate = 1; }
  ~AbandonmentTest() override {
    gate_.open(1000);
    for (auto& thread : threads_) thread.join();
    queue_.reset();
  }

  JobQueue& queue() {
    if (!queue_)
      queue_ = std::make_unique<JobQueue>(
          *store_, options_, json::write_problem, [this](const store::JobRecord&) { ++observed_; },
          [this](const std::string& line) {
            if (log_fails_.exchange(false)) throw std::runtime_error("the log fails");
            const std::lock_guard lock(mutex_);
            log_.emplace_back(log::context_text()) += line;
            changed_.notify_all();
          });
    return *queue_;
  }

  Computation held(bool& runs, double deadline) {
    return computation(
        [this, &runs](const Execution&) {
          runs = true;
          gate_.pass();
          return store::Result{"text/plain", {}, "late"};
        },
        deadline);
  }

  struct Told {
    std::string code;
    bool is_replaced = false;
    Clock::time_point at;
  };
  Waiting client(std::function<bool()> hung_up = {}) {
    return {std::move(hung_up), [this](const problem::Problem& problem, bool is_replaced) {
              const std::lock_guard lock(mutex_);
              told_.push_back({problem.code, is_replaced, Clock::now()});
              changed_.notify_all();
            }};
  }
  /// The answer that the client of the computation with this number, counted from 1, gets in its place.
  Told wait_until_told(std::size_t number = 1) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, patience, [&] { return told_.size() >= number; }));
    return told_.size() < number ? Told{} : told_[number - 1];
  }
  std::vector<std::string> wait_for_log(std::size_t lines) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, patience, [&] { return log_.size() >= lines; }));
    auto log = log_;
    if (log.size() < lines) log.resize(lines);
    return log;
  }
  static void wait_for(const std::function<bool()>& condition) {
    const auto end = Clock::now() + patience;
    while (!condition() && Clock::now() < end) std::this_thread::sleep_for(1ms);
    EXPECT_TRUE(condition());
  }

  /// Starts a computation on a thread of its own, and waits until it is held at the gate.
  void begin_held(std::function<bool()> hung_up = {}, double deadline = short_deadline) {
    threads_.emplace_back([this, deadline, hung_up = std::move(hung_up)] {
      const log::Context context("request", "0123");
      std::string code;
      // On a busy machine the deadline may pass before the computation runs; then it is tried again.
      for (bool runs = false; !runs;) code = code_of([&] { queue().run_now(held(runs, deadline), client(hung_up)); });
      const std::lock_guard lock(mutex_);
      codes_.push_back(code);
      changed_.notify_all();
    });
    gate_.wait_for(++begun_);
  }
  std::vector<std::string> wait_until_returned(std::size_t count = 1) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, patience, [&] { return codes_.size() >= count; }));
    return codes_;
  }

  std::string run_another(double deadline = 60) {
    const auto another = computation([](const Execution&) { return store::Result{"text/plain", {}, "42"}; }, deadline);
    std::string body;
    const auto code = code_of([&] { body = queue().run_now(another, {}).body; });
    return body.empty() ? code : body;
  }

  std::unique_ptr<JobQueue> queue_;
  Gate gate_;
  std::vector<std::thread> threads_;
  int begun_ = 0;
  std::atomic<int> observed_{0};
  std::atomic<bool> log_fails_{false};  ///< whether the next line of the log makes it throw
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Told> told_;
  std::vector<std::string> codes_;  ///< codes of the errors with which held computations ended
  std::vector<std::string> log_;
};

TEST_F(AbandonmentTest, WhoWaitsIsToldOfTheDeadlineASecondAfterItWhateverTheComputationDoes) {
  queue();
  const auto begin = Clock::now();
  begin_held();
  const auto told = wait_until_told();
  EXPECT_EQ(told.code, "job.deadline_exceeded");
  EXPECT_TRUE(told.is_replaced);
  EXPECT_GE(told.at - begin, 1s + 50ms);
  EXPECT_EQ(queue().abandoned(), 1U);
}

TEST_F(AbandonmentTest, TheResultOfAnAbandonedComputationIsDropped) {
  queue();
  begin_held();
  wait_until_told();
  gate_.open();
  EXPECT_EQ(wait_until_returned(), std::vector<std::string>{"job.deadline_exceeded"});
  EXPECT_EQ(told_.size(), 1U);
  EXPECT_EQ(queue().abandoned(), 0U);
  EXPECT_EQ(queue().immediate(), 0);
}

TEST_F(AbandonmentTest, TheResultOfAnAbandonedSearchIsDroppedThoughItHasTakenItsStopBack) {
  queue();
  threads_.emplace_back([this] {
    std::string code;
    // On a busy machine the deadline may pass before the computation runs; then it is tried again.
    for (bool runs = false; !runs;) {
      const auto search = computation(
          [this, &runs](const Execution& execution) {
            runs = true;
            gate_.pass();
            EXPECT_TRUE(execution.cancellation.resume(StopReason::deadline));
            return store::Result{"text/plain", {}, "the best"};
          },
          short_deadline);
      code = code_of([&] { queue().run_now(search, client()); });
    }
    const std::lock_guard lock(mutex_);
    codes_.push_back(code);
    changed_.notify_all();
  });
  gate_.wait_for(++begun_);
  EXPECT_EQ(wait_until_told().code, "job.deadline_exceeded");
  gate_.open();
  EXPECT_EQ(wait_until_returned(), std::vector<std::string>{"job.deadline_exceeded"});
}

TEST_F(AbandonmentTest, WhatAClientThatHasHungUpLeavesBehindIsAbandonedLongBeforeItsDeadline) {
  queue();
  begin_held([] { return true; }, 3600);
  EXPECT_EQ(wait_until_told().code, "job.cancelled");
  EXPECT_EQ(run_another(), "42");
}

TEST_F(AbandonmentTest, AnotherComputationGetsTheSlotWhileTheAbandonedOneIsHeld) {
  queue();
  begin_held();
  EXPECT_EQ(run_another(), "42");
  EXPECT_TRUE(wait_until_told().is_replaced);
}

TEST_F(AbandonmentTest, NoMoreSlotsAreGivenUpThanThereAre) {
  for (const int slots : {1, 3}) {
    queue_.reset();
    told_.clear();
    codes_.clear();
    options_.immediate = slots;
    queue();
    for (int i = 0; i < slots; ++i) begin_held();
    wait_until_told(static_cast<std::size_t>(slots));
    for (int i = 0; i < slots; ++i) begin_held();
    wait_until_told(static_cast<std::size_t>(2 * slots));
    int replaced = 0;
    for (const auto& told : told_) {
      EXPECT_EQ(told.code, "job.deadline_exceeded") << "also of those beyond";
      replaced += told.is_replaced ? 1 : 0;
    }
    EXPECT_EQ(replaced, slots);
    EXPECT_EQ(queue().abandoned(), static_cast<std::size_t>(2 * slots));
    EXPECT_EQ(run_another(short_deadline), "job.deadline_exceeded") << "it has no slot";
    gate_.open();
    EXPECT_EQ(run_another(), "42") << "one has returned, whichever it was";
    gate_.open(2 * slots - 1);
    wait_until_returned(static_cast<std::size_t>(2 * slots));
    EXPECT_EQ(queue().abandoned(), 0U);
    for (auto& thread : threads_) thread.join();
    threads_.clear();
  }
}

TEST_F(AbandonmentTest, SlotsAreNoMoreThanBeforeOnceTheAbandonedComputationHasReturned) {
  queue();
  begin_held();
  wait_until_told();
  gate_.open();
  wait_until_returned();
  begin_held({}, 60);
  EXPECT_EQ(run_another(short_deadline), "job.deadline_exceeded");
}

TEST_F(AbandonmentTest, AComputationThatStopsInTimeIsNotAbandoned) {
  const auto stopping = computation(
      [](const Execution& execution) -> store::Result {
        while (true) {
          execution.checkpoint(0.5, "spinning");
          std::this_thread::sleep_for(1ms);
        }
      },
      short_deadline);
  EXPECT_EQ(code_of([&] { queue().run_now(stopping, client()); }), "job.deadline_exceeded");
  EXPECT_TRUE(told_.empty());
  EXPECT_TRUE(log_.empty());
}

TEST_F(AbandonmentTest, TheLogNamesTheRequestOnceAtTheAbandonmentAndOnceAtTheReturn) {
  queue();
  begin_held();
  auto log = wait_for_log(1);
  EXPECT_EQ(log.at(0).find("request=0123 the computation geodesics does not stop: abandoned 1."), 0U) << log.at(0);
  EXPECT_NE(log.at(0).find(" s after its deadline"), std::string::npos) << log.at(0);
  gate_.open();
  wait_until_returned();
  log = wait_for_log(2);
  EXPECT_EQ(log.at(1).find("request=0123 the abandoned computation geodesics has returned"), 0U) << log.at(1);
  EXPECT_EQ(log.size(), 2U);
}

TEST_F(AbandonmentTest, TheEndOfTheServerDoesNotWaitForAnAbandonedComputation) {
  queue();
  begin_held();
  wait_until_told();
  const auto begin = Clock::now();
  queue().shut_down(3600);
  EXPECT_LT(Clock::now() - begin, 10min);
}

/// Tests of jobs that do not check for a stop request, on one worker.
class AbandonedJobTest : public AbandonmentTest {
 protected:
  std::string submit_held(double deadline = short_deadline) {
    auto job = computation(
        [this](const Execution& execution) {
          gate_.pass();
          execution.progress->report(1, "late");
          return store::Result{"text/plain", {}, "late"};
        },
        deadline);
    return queue().submit(std::move(job)).record.id;
  }
  /// Submits a job that is held at the gate, again if the machine is so busy that its deadline passes before it runs.
  std::string begin_held_job() {
    ++begun_;
    while (true) {
      const auto id = submit_held(0.3);
      while (gate_.arrived() < begun_ && !queue().status(id).record.finished) std::this_thread::sleep_for(1ms);
      if (gate_.arrived() >= begun_) return id;
    }
  }
  std::string submit_another() {
    return queue()
        .submit(computation([](const Execution&) {
          return store::Result{"text/plain", {}, "42"};
        }))
        .record.id;
  }
  store::JobRecord wait_until_finished(const std::string& id) {
    std::uint64_t version = 0;
    const auto end = Clock::now() + patience;
    auto record = queue().wait_for_change(id, version, 1).record;
    while (!record.finished && Clock::now() < end) record = queue().wait_for_change(id, version, 1).record;
    EXPECT_NE(record.finished, 0) << "the job does not finish";
    return record;
  }
};

TEST_F(AbandonedJobTest, AJobFailsWithItsDeadlineWhileItsComputationIsHeldAndAnotherIsRun) {
  const auto id = begin_held_job();
  const auto other = submit_another();
  const auto failed = wait_until_finished(id);
  EXPECT_EQ(failed.state, store::JobState::failed);
  EXPECT_EQ(failed.error_status, 504);
  EXPECT_NE(failed.error.find("job.deadline_exceeded"), std::string::npos) << failed.error;
  EXPECT_GE(failed.finished - failed.created, 1290) << "a second of patience after a deadline of 0.3 s";
  EXPECT_EQ(wait_until_finished(other).state, store::JobState::successful);
  EXPECT_EQ(queue().abandoned(), 1U) << "it is held";
  wait_for([this] { return queue().running() == 0; });
}

TEST_F(AbandonedJobTest, AJobThatIsHeldFailsWithItsDeadlineEvenIfTheLogFails) {
  log_fails_ = true;
  const auto failed = wait_until_finished(begin_held_job());
  EXPECT_EQ(failed.error_status, 504);
  EXPECT_FALSE(log_fails_);
}

TEST_F(AbandonedJobTest, TheLateResultOfAJobIsDroppedAndItsEndIsToldOfOnce) {
  const auto id = begin_held_job();
  wait_until_finished(id);
  wait_for_log(1);
  gate_.open();
  const auto log = wait_for_log(2);
  EXPECT_EQ(log.at(0).find("job=" + id + " the computation geodesics does not stop: abandoned "), 0U) << log.at(0);
  EXPECT_EQ(log.at(1).find("job=" + id + " the abandoned computation geodesics has returned "), 0U) << log.at(1);
  const auto failed = queue().status(id).record;
  EXPECT_EQ(failed.state, store::JobState::failed);
  EXPECT_EQ(queue().abandoned(), 0U);
  wait_for([this] { return observed_ == 1; });
  EXPECT_TRUE(fs::is_empty(folder_ / "results"));
  EXPECT_EQ(wait_until_finished(submit_another()).state, store::JobState::successful);
}

TEST_F(AbandonedJobTest, NoMoreWorkersAreReplacedThanThereAre) {
  for (const int workers : {1, 2}) {
    queue_.reset();
    options_.workers = workers;
    std::vector<std::string> held;
    for (int i = 0; i < workers; ++i) held.push_back(begin_held_job());
    for (const auto& id : held) EXPECT_EQ(wait_until_finished(id).state, store::JobState::failed);
    for (int i = 0; i < workers; ++i) held.push_back(begin_held_job());
    for (const auto& id : held) EXPECT_EQ(wait_until_finished(id).state, store::JobState::failed);
    EXPECT_EQ(queue().abandoned(), static_cast<std::size_t>(2 * workers));
    EXPECT_EQ(queue().running(), static_cast<std::size_t>(workers)) << "the workers of those beyond are held";
    const auto other = submit_another();
    EXPECT_EQ(queue().status(other).record.state, store::JobState::accepted);
    gate_.open();
    EXPECT_EQ(wait_until_finished(other).state, store::JobState::successful) << "whichever has returned";
    gate_.open(2 * workers - 1);
    wait_for([this] { return queue().abandoned() == 0; });
  }
}

TEST_F(AbandonedJobTest, NoMoreJobsRunThanThereAreWorkersOnceTheAbandonedOneHasReturned) {
  const auto id = begin_held_job();
  wait_until_finished(id);
  wait_for_log(1);
  gate_.open();
  wait_for_log(2);
  submit_held(60);
  gate_.wait_for(2);
  const auto other = submit_another();
  std::uint64_t version = 0;
  queue().wait_for_change(other, version, 0);
  EXPECT_EQ(queue().wait_for_change(other, version, 0.5).record.state, store::JobState::accepted);
  EXPECT_EQ(queue().running(), 1U);
  gate_.open();
  EXPECT_EQ(wait_until_finished(other).state, store::JobState::successful);
}

TEST_F(AbandonedJobTest, TheWorkerOfADismissedJobThatIsHeldIsReplaced) {
  const auto id = submit_held(3600);
  gate_.wait_for(1);
  queue().remove(id);
  EXPECT_EQ(wait_until_finished(submit_another()).state, store::JobState::successful);
  EXPECT_EQ(queue().status(id).record.state, store::JobState::dismissed);
}

TEST_F(AbandonedJobTest, WhoWaitsForAJobThatIsHeldIsToldOfItsDeadline) {
  auto job = computation(
      [this](const Execution&) {
        gate_.pass();
        return store::Result{"text/plain", {}, "late"};
      },
      short_deadline);
  EXPECT_EQ(code_of([&] { queue().run_within(std::move(job), 60, {}); }), "job.deadline_exceeded");
}

TEST_F(AbandonedJobTest, WhatAClientThatHungUpWhileItWaitedLeavesBehindIsAbandonedLongBeforeItsDeadline) {
  auto job = computation(
      [this](const Execution&) {
        gate_.pass();
        return store::Result{"text/plain", {}, "late"};
      },
      3600);
  const auto has_begun = [this] { return gate_.arrived() > 0; };
  EXPECT_EQ(code_of([&] { queue().run_within(std::move(job), 60, has_begun); }), "job.cancelled");
  EXPECT_EQ(wait_until_finished(submit_another()).state, store::JobState::successful);
}

TEST_F(AbandonedJobTest, TheEndOfTheServerDoesNotWaitForAnAbandonedJob) {
  wait_until_finished(begin_held_job());
  wait_for_log(1);
  const auto begin = Clock::now();
  queue().shut_down(3600);
  EXPECT_LT(Clock::now() - begin, 10min);
  EXPECT_EQ(queue().abandoned(), 1U);
}

}  // namespace
}  // namespace supple::jobs
