#include <algorithm>
#include <atomic>
#include <string>
#include <thread>

#include "shared_store_fixture.h"

namespace supple::store {
namespace {

TEST_F(SharedStoreTest, TakesTheJobsOfAServerThatIsNotHeardOf) {
  SharedStore lost(options(0.05));
  SharedStore other(options());
  auto job = running(lost, "job");
  wait_milliseconds(100);
  const auto taken = other.leases()->lease_jobs({.foreground = 0});
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].id, "job");
  EXPECT_EQ(taken[0].state, JobState::running);
  EXPECT_EQ(taken[0].attempts, 1);
  EXPECT_EQ(taken[0].fencing_token, job.fencing_token + 1);
  EXPECT_EQ(other.leases()->lease_jobs({.foreground = 5}).size(), 0U) << "it has them already";

  // The lost server goes on without knowing that it was lost: its reports are refused.
  const Result late{"text/plain", {}, "late"};
  EXPECT_FALSE(lost.jobs().update_job(job));
  EXPECT_FALSE(lost.jobs().finish_job(ended(job), &late));
  EXPECT_EQ(lost.leases()->renew_leases({}).size(), 0U);
  EXPECT_EQ(other.jobs().job("job")->finished, 0);
  const Result right{"text/plain", {}, "right"};
  EXPECT_TRUE(other.jobs().finish_job(ended(taken[0]), &right));
  EXPECT_FALSE(lost.jobs().finish_job(ended(job), &late));
  EXPECT_EQ(lost.blobs().job_result("job").body.text(), "right");
  EXPECT_EQ(files_in(folder_ / "data" / "results"), 1U) << "the late one has left no file";
}

TEST_F(SharedStoreTest, RemovesTheFileOfAServerThatWasLostBeforeItsRow) {
  SharedStore lost(options(0.05));
  SharedStore other(options());
  running(lost, "job");
  std::ofstream(folder_ / "data" / "results" / "job.0.result") << "its row is missing";
  wait_milliseconds(100);
  const auto taken = other.leases()->lease_jobs({.foreground = 0});
  ASSERT_EQ(taken.size(), 1U);
  const Result result{"text/plain", {}, "right"};
  EXPECT_TRUE(other.jobs().finish_job(ended(taken[0]), &result));
  EXPECT_EQ(files_in(folder_ / "data" / "results"), 1U);
  EXPECT_EQ(other.blobs().job_result("job").body.text(), "right");
}

TEST_F(SharedStoreTest, GivesTheMostUrgentJobsToWorkersThatHaveTimeForThem) {
  SharedStore one(options());
  SharedStore two(options());
  for (const auto priority : {Priority::background, Priority::normal, Priority::interactive}) {
    auto job = new_job(std::string(priority_name(priority)));
    job.priority = priority;
    one.jobs().add_job(job, "request");
  }
  const auto urgent = two.leases()->lease_jobs({.foreground = 1});
  ASSERT_EQ(urgent.size(), 1U);
  EXPECT_EQ(urgent[0].id, "interactive") << "though it came last";
  const auto quiet = two.leases()->lease_jobs({.background = 3});
  ASSERT_EQ(quiet.size(), 1U) << "the normal one is not for workers of the background";
  EXPECT_EQ(quiet[0].id, "background");
  EXPECT_EQ(two.leases()->lease_jobs({.foreground = 3}).at(0).id, "normal");
}

TEST_F(SharedStoreTest, LeavesJobsToAServerThatIsHeardOf) {
  SharedStore one(options());
  SharedStore two(options());
  running(one, "runs");
  one.jobs().add_job(new_job("waits"), "request");
  EXPECT_EQ(two.leases()->lease_jobs({.foreground = 0}).size(), 0U) << "it has no time for them";
  const auto taken = two.leases()->lease_jobs({.foreground = 5});
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].id, "waits");
  EXPECT_EQ(two.leases()->lease_jobs({.foreground = 5}).size(), 0U)
      << "its own are not taken again, though they have not begun";
  const auto held = one.leases()->renew_leases({});
  ASSERT_EQ(held.size(), 1U);
  EXPECT_EQ(held[0].id, "runs");
}

TEST_F(SharedStoreTest, TakesEachJobOnce) {
  SharedStore source(options());
  SharedStore one(options());
  SharedStore two(options());
  constexpr int jobs = 60;
  for (int i = 0; i < jobs; ++i) {
    const auto job = new_job("job" + std::to_string(i));
    source.jobs().add_job(job, "request");
    source.jobs().update_job(job);  // the job waits, and no server has it
  }
  std::atomic<int> taken{0};
  const auto take = [&](SharedStore& server) {
    for (int i = 0; i < jobs; ++i) taken += static_cast<int>(server.leases()->lease_jobs({.foreground = 0}).size());
  };
  std::thread first([&] { take(one); });
  take(two);
  first.join();
  EXPECT_EQ(taken, jobs);
  EXPECT_EQ(one.leases()->renew_leases({}).size() + two.leases()->renew_leases({}).size(),
            static_cast<std::size_t>(jobs));
}

TEST_F(SharedStoreTest, FreesItsJobsAtItsEnd) {
  SharedStore other(options());
  {
    SharedStore ends(options());
    ends.jobs().add_job(new_job("waits"), "request");
    auto job = running(ends, "put back");
    job.state = JobState::accepted;
    EXPECT_TRUE(ends.jobs().update_job(job));
    EXPECT_EQ(other.leases()->lease_jobs({.foreground = 0}).size(), 1U) << "one that is put back is free at once";
  }
  EXPECT_EQ(other.leases()->lease_jobs({.foreground = 0}).size(), 1U);
}

TEST_F(SharedStoreTest, RefusesTheFormerTokenOfAJobThatAServerLostAndTookAgain) {
  SharedStore one(options());
  SharedStore two(options());
  const auto former = running(one, "job");
  const auto put_back = [](SharedStore& server, JobRecord job) {
    job.state = JobState::accepted;
    EXPECT_TRUE(server.jobs().update_job(job));
  };
  put_back(one, former);
  put_back(two, two.leases()->lease_jobs({.foreground = 1}).at(0));
  const auto present = one.leases()->lease_jobs({.foreground = 1}).at(0);
  EXPECT_FALSE(one.jobs().update_job(former));
  const Result result{"text/plain", {}, "answer"};
  EXPECT_FALSE(one.jobs().finish_job(ended(former), &result));
  EXPECT_TRUE(one.jobs().finish_job(ended(present), &result));
}

TEST_F(SharedStoreTest, TakesNoNewJobsBesideThoseOfALostServerBeyondItsTime) {
  SharedStore waiting(options());
  SharedStore lost(options(0.05));
  SharedStore other(options());
  for (const char* id : {"a", "b", "c"}) running(lost, id);
  waiting.jobs().add_job(new_job("waits"), "request");
  wait_milliseconds(100);
  EXPECT_EQ(other.leases()->lease_jobs({.foreground = 1}).size(), 3U);
  EXPECT_EQ(other.leases()->lease_jobs({.foreground = 1}).at(0).id, "waits");
}

TEST_F(SharedStoreTest, TakesTheJobsOfALostServerByTheirKind) {
  SharedStore lost(options(0.05));
  SharedStore other(options());
  const auto add = [&](const std::string& id, Priority priority) {
    auto job = new_job(id);
    job.priority = priority;
    lost.jobs().add_job(job, "request");
  };
  for (int i = 0; i < 12; ++i) add("normal" + std::to_string(i), Priority::normal);
  for (int i = 0; i < 2; ++i) add("background" + std::to_string(i), Priority::background);
  wait_milliseconds(100);
  const auto taken = other.leases()->lease_jobs({.foreground = 0, .background = 12});
  const auto in_background = std::count_if(taken.begin(), taken.end(),
                                           [](const JobRecord& job) { return job.priority == Priority::background; });
  EXPECT_EQ(in_background, 2);
  EXPECT_EQ(taken.size(), 10U) << "of the others no more than one call takes for which no worker is idle";
}

}  // namespace
}  // namespace supple::store
