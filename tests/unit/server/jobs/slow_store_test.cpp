// What a queue does while its store takes long, or fails.

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "job_queue_fixture.h"
#include "store_doubles.h"
#include "supple/store/store_error.h"
#include "unit/server/held_computation.h"

namespace supple::jobs {
namespace {

using namespace std::chrono_literals;

class SlowStoreTest : public JobQueueTest {
 protected:
  void SetUp() override {
    store_.reset();
    auto store = std::make_unique<TestStore>(folder_);
    slow_ = store.get();
    store_ = std::move(store);
  }
  void TearDown() override {
    gate_.open(1000);
    join_threads();
    queue_.reset();
  }

  /// Reports its progress again and again, until it is stopped or told to end.
  Computation reporting() {
    return computation([this](const Execution& execution) {
      for (started_ = 1; !is_to_end_; ++reports_) {
        execution.cancellation.throw_if_requested();
        execution.progress->publish("{}");
        execution.checkpoint(0.5, "reporting");
        std::this_thread::sleep_for(1ms);
      }
      return store::Result{"text/plain", {}, "done"};
    });
  }
  bool reports_go_on() {
    const int before = reports_;
    for (int i = 0; i < 10'000 && reports_ < before + 300; ++i) std::this_thread::sleep_for(1ms);
    return reports_ >= before + 300;
  }
  void in_thread(std::function<void()> call) { threads_.emplace_back(std::move(call)); }
  void join_threads() {
    for (auto& thread : threads_) thread.join();
    threads_.clear();
  }
  /// Holds the store at the gate when a job is put back. Called before the queue exists, whose threads use the hook.
  void hold_jobs_that_are_left() {
    remake_ = echo;
    slow_->hooked_jobs.at_update = [this](const store::JobRecord& job) {
      if (job.state == JobState::accepted) gate_.pass();
    };
  }
  /// Begins a job that the next process can run.
  std::string begin_job_to_leave() {
    auto id = queue().submit(endless(), request("x")).record.id;
    wait_until_started();
    return id;
  }

  TestStore* slow_ = nullptr;
  Gate gate_;
  std::atomic<bool> is_to_end_{false};
  std::atomic<int> reports_{0};
  std::vector<std::thread> threads_;
};

TEST_F(SlowStoreTest, AComputationReportsItsProgressWhileAJobIsAdded) {
  queue().submit(reporting());
  wait_until_started();
  slow_->hooked_jobs.at_add = [this](const store::JobRecord&) { gate_.pass(); };
  std::string added;
  in_thread([&] { added = queue().submit(answering("x")).record.id; });
  gate_.wait_for(1);
  EXPECT_TRUE(reports_go_on());
  EXPECT_EQ(queue().waiting(), 1U) << "it has its place already";
  EXPECT_EQ(queue().run_now(answering("now"), {}).body, "now");
  is_to_end_ = true;
  gate_.open();
  join_threads();
  EXPECT_EQ(wait_until_finished(added).record.state, JobState::successful);
}

TEST_F(SlowStoreTest, AComputationReportsItsProgressWhileItBecomesAJob) {
  slow_->hooked_jobs.at_add = [this](const store::JobRecord&) { gate_.pass(); };
  JobQueue::ResultOrJob outcome;
  in_thread([&] { outcome = queue().run_within(reporting(), 0.05, {}); });
  gate_.wait_for(1);
  EXPECT_TRUE(reports_go_on());
  is_to_end_ = true;
  gate_.open();
  join_threads();
  ASSERT_FALSE(outcome.result) << "it became a job before it ended";
  EXPECT_EQ(wait_until_finished(outcome.job.record.id).record.state, JobState::successful);
  EXPECT_EQ(queue().result(outcome.job.record.id).body.text(), "done");
}

TEST_F(SlowStoreTest, NobodyWaitsForTheStoreWhileAJobIsLeftToTheNextProcess) {
  hold_jobs_that_are_left();
  const auto left = begin_job_to_leave();
  in_thread([&] { queue().shut_down(0); });
  gate_.wait_for(1);
  auto status = std::async(std::launch::async, [&] { return queue().status(left); });
  EXPECT_EQ(status.wait_for(60s), std::future_status::ready);
  gate_.open();
  join_threads();
  EXPECT_EQ(status.get().record.id, left);
  EXPECT_EQ(store_->jobs().job(left)->state, JobState::accepted);
}

TEST_F(SlowStoreTest, AJobThatIsRemovedWhileItIsLeftToTheNextProcessIsRunByNobody) {
  hold_jobs_that_are_left();
  const auto left = begin_job_to_leave();
  in_thread([&] { queue().shut_down(0); });
  gate_.wait_for(1);
  std::optional<JobStatus> status = JobStatus{};
  in_thread([&] { status = queue().remove(left); });
  std::this_thread::sleep_for(50ms);
  gate_.open();
  join_threads();
  EXPECT_FALSE(status) << "it is removed";
  EXPECT_FALSE(store_->jobs().job(left));
  EXPECT_FALSE(store_->blobs().has_request(left));
}

TEST_F(SlowStoreTest, AJobThatIsDismissedWhileItIsAddedIsDismissedInTheStore) {
  std::mutex mutex;
  std::string id;
  slow_->hooked_jobs.at_add = [&](const store::JobRecord& job) {
    {
      const std::lock_guard lock(mutex);
      id = job.id;
    }
    gate_.pass();
  };
  in_thread([&] { queue().submit(endless()); });
  gate_.wait_for(1);
  std::optional<JobStatus> dismissed;
  const auto known = [&] {
    const std::lock_guard lock(mutex);
    return id;
  }();
  in_thread([&] { dismissed = queue().remove(known); });
  std::this_thread::sleep_for(50ms);
  gate_.open();
  join_threads();
  ASSERT_TRUE(dismissed);
  EXPECT_EQ(dismissed->record.state, JobState::dismissed);
  EXPECT_EQ(store_->jobs().job(known)->state, JobState::dismissed);
  EXPECT_EQ(queue().waiting(), 0U);
}

TEST_F(SlowStoreTest, AJobThatTheStoreRefusesLeavesItsPlaceInTheQueue) {
  options_.max_queue = 1;
  slow_->hooked_jobs.at_add = [](const store::JobRecord&) { throw store::StoreFull("There is no space."); };
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(code_of([&] { queue().submit(answering("x"), request("x")); }), "store.full");
  }
  EXPECT_EQ(queue().waiting(), 0U);
  EXPECT_TRUE(fs::is_empty(folder_ / "requests"));
  EXPECT_EQ(code_of([&] { queue().run_within(endless(), 0.05, {}); }), "store.full");
  for (int i = 0; i < 10'000 && queue().running() > 0; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(queue().running(), 0U) << "what nobody can ask for is stopped";
}

TEST_F(SlowStoreTest, AnEndThatTheStoreRefusesIsShownAndWrittenOnceTheStoreTakesIt) {
  std::atomic<bool> is_full{true};
  slow_->hooked_jobs.at_finish = [&](const store::JobRecord&, const store::Result*) {
    if (is_full) throw store::StoreFull("There is no space.");
  };
  const auto id = queue().submit(answering("x")).record.id;
  const auto status = wait_until_finished(id);
  EXPECT_EQ(status.record.state, JobState::failed);
  EXPECT_EQ(status.record.error_status, 507);
  EXPECT_EQ(store_->jobs().job(id)->state, JobState::running);
  const auto listed = [&](JobState state) { return queue().list(state, 10, "").size(); };
  EXPECT_EQ(listed(JobState::failed), 1U);
  EXPECT_EQ(listed(JobState::running), 0U);
  is_full = false;
  for (int i = 0; i < 10'000 && store_->jobs().job(id)->state == JobState::running; ++i)
    std::this_thread::sleep_for(1ms);
  EXPECT_EQ(store_->jobs().job(id)->error, status.record.error);
  EXPECT_FALSE(queue().remove(id));
  EXPECT_EQ(code_of([&] { queue().status(id); }), "job.not_found");
}

TEST_F(SlowStoreTest, ProgressThatAFailedRenewalDidNotShareIsSharedByTheNextOne) {
  std::atomic<int> renewals{0};
  std::mutex mutex;
  std::vector<std::string> shared;
  slow_->own_leases.emplace(slow_->jobs());
  slow_->own_leases->at_renewal = [&](const std::vector<store::JobProgress>& running) {
    if (running.empty()) return;
    if (++renewals == 1) throw store::StoreUnavailable("The database does not answer.");
    const std::lock_guard lock(mutex);
    for (const auto& progress : running) shared.push_back(progress.stage);
  };
  const auto id = queue()
                      .submit(computation([this](const Execution& execution) {
                        execution.progress->report(0.5, "half");
                        gate_.pass();
                        return store::Result{"text/plain", {}, "done"};
                      }))
                      .record.id;
  gate_.wait_for(1);
  const auto is_shared = [&] {
    const std::lock_guard lock(mutex);
    return !shared.empty() && shared.back() == "half";
  };
  for (int i = 0; i < 10'000 && !is_shared(); ++i) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(is_shared());
  EXPECT_GE(renewals, 2);
  gate_.open();
  wait_until_finished(id);
  queue_.reset();  // its threads use what this test has declared
}

TEST_F(SlowStoreTest, TheKeeperOfLeasesGoesOnWhateverItMeets) {
  std::atomic<int> renewals{0};
  slow_->own_leases.emplace(slow_->jobs());
  slow_->own_leases->at_renewal = [&](const std::vector<store::JobProgress>&) {
    if (++renewals == 1) throw std::runtime_error("no error of the store");
  };
  queue();
  for (int i = 0; i < 10'000 && renewals < 3; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_GE(renewals, 3);
  queue_.reset();  // its threads use what this test has declared
}

TEST_F(SlowStoreTest, TheKeeperOfLeasesDoesNotWaitForAnEndThatIsBeingStored) {
  std::atomic<int> renewals{0};
  std::atomic<bool> are_lost{false};
  slow_->own_leases.emplace(slow_->jobs());
  slow_->own_leases->at_renewal = [&](const std::vector<store::JobProgress>&) { ++renewals; };
  slow_->own_leases->is_leased = [&] { return !are_lost; };
  slow_->hooked_jobs.at_finish = [this](const store::JobRecord&, const store::Result*) { gate_.pass(); };
  const auto id = queue().submit(answering("x")).record.id;
  gate_.wait_for(1);
  are_lost = true;
  const int before = renewals;
  for (int i = 0; i < 10'000 && renewals < before + 3; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_GE(renewals, before + 3);
  gate_.open();
  EXPECT_EQ(wait_until_finished(id).record.state, JobState::successful);
  queue_.reset();  // its threads use what this test has declared
}

TEST_F(SlowStoreTest, TheCleanerGoesOnWhateverItMeets) {
  std::atomic<int> calls{0};
  options_.clean_up_too = [&] {
    ++calls;
    throw std::runtime_error("no error of the store");
  };
  const auto running = queue().submit(endless()).record.id;
  wait_until_started();
  for (int i = 0; i < 10'000 && calls < 1; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(calls, 1);
  auto late = endless(0.05);
  const auto id = queue().submit(std::move(late)).record.id;
  EXPECT_EQ(wait_until_finished(id).record.state, JobState::failed) << "at its deadline, while it waits";
  queue().remove(running);
}

}  // namespace
}  // namespace supple::jobs
