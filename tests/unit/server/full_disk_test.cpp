// What happens on a full disk. A program of its own: it may have to enter a user namespace before it starts threads.

#include <algorithm>
#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "jobs/job_queue_fixture.h"
#include "store/store_fixture.h"
#include "support/small_disk.h"

namespace supple::store {
namespace {

TEST_F(StoreTest, SaysThatTheDiskIsFullAndTakesWritesAgainOnceThereIsSpace) {
  const testing::SmallDisk disk(folder_);
  LocalStore store(folder_);
  auto job = new_job("j");
  store.jobs().add_job(job);
  job.state = JobState::successful;
  const Result large{"text/plain", {}, std::string(2 << 20, 'x')};
  EXPECT_EQ(code_of([&] { store.meshes().add_mesh(large.body, describe); }), "store.full");
  EXPECT_EQ(code_of([&] { store.jobs().finish_job(job, &large); }), "store.full");
  disk.fill();
  EXPECT_EQ(code_of([&] {
              for (int i = 0; i < 1000; ++i) store.jobs().add_job(new_job("more" + std::to_string(i)));
            }),
            "store.full")
      << "the database says so too";
  disk.make_space();
  const Result small{"text/plain", {}, "x"};
  store.jobs().finish_job(job, &small);
  EXPECT_EQ(store.blobs().job_result("j").body.text(), "x");
}

TEST_F(StoreTest, RemovesOnAFullDiskInThePlaceOfItsReserve) {
  const testing::SmallDisk disk(folder_);
  const auto add_expired = [](Store& store, const std::string& id) {
    auto job = new_job(id);
    store.jobs().add_job(job);
    job.state = JobState::successful;
    job.finished = 1000;
    job.expires = 1500;
    const Result result{"text/plain", {}, "42"};
    store.jobs().finish_job(job, &result);
  };
  LocalStore store(folder_);
  const auto mesh = store.meshes().add_mesh("abc", describe).first.id;
  const auto unused = store.meshes().add_mesh("unused", describe).first.id;
  store.meshes().note_mesh_use(unused);
  add_expired(store, "j");
  ASSERT_EQ(fs::file_size(folder_ / "reserve"), 256U << 10);
  fs::remove(folder_ / "reserve");
  disk.fill();
  EXPECT_EQ(code_of([&] { store.jobs().remove_expired_jobs(2000, 10); }), "store.full") << "without a reserve";
  EXPECT_EQ(store.blobs().job_result("j").body.text(), "42") << "the row is still there, and so is its file";
  disk.make_space();
  EXPECT_EQ(store.jobs().remove_expired_jobs(2000, 10), 1U);
  EXPECT_TRUE(fs::is_empty(folder_ / "results"));
  const std::vector<std::pair<const char*, std::function<bool()>>> removals{
      {"expired jobs", [&] { return store.jobs().remove_expired_jobs(2000, 10) == 1; }},
      {"a job", [&] { return store.jobs().remove_job("k"); }},
      {"a mesh", [&] { return store.meshes().remove_mesh(mesh); }},
      {"unused meshes", [&] { return !store.meshes().remove_unused_meshes(now_milliseconds() + 1000).empty(); }},
  };
  for (const auto& [name, removal] : removals) {
    store.jobs().remove_job("k");
    add_expired(store, "k");
    store.jobs().remove_expired_jobs(1000, 10);
    ASSERT_EQ(fs::file_size(folder_ / "reserve"), 256U << 10) << name << ": taken again";
    disk.fill();
    EXPECT_TRUE(removal()) << name;
    disk.make_space();
  }
  EXPECT_FALSE(store.meshes().mesh(mesh));
  EXPECT_FALSE(store.meshes().mesh(unused));
}

}  // namespace
}  // namespace supple::store

namespace supple::jobs {
namespace {

/// A queue over a store on a disk of 1 MiB.
class FullDiskTest : public JobQueueTest {
 protected:
  void SetUp() override {
    store_.reset();
    disk_.emplace(folder_);
    store_ = std::make_unique<store::LocalStore>(folder_);
    start();
  }
  void TearDown() override {
    queue_.reset();
    store_.reset();
    disk_.reset();
  }

  void start() {
    queue_ = std::make_unique<JobQueue>(
        *store_, options_, json::write_problem, [](const store::JobRecord&) {},
        [this](const std::string&) { ++logged_; });
  }

  Computation waiting() {
    return computation([this](const Execution&) {
      ++started_;
      while (!open_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return store::Result{"text/plain", {}, "42"};
    });
  }
  bool in_list(std::optional<JobState> state, const std::string& id) {
    const auto list = queue().list(state, 10, "");
    return std::any_of(list.begin(), list.end(), [&](const auto& status) { return status.record.id == id; });
  }

  std::optional<testing::SmallDisk> disk_;
  std::atomic<bool> open_{false};
  std::atomic<int> logged_{0};
};

TEST_F(FullDiskTest, FailsAJobWhoseResultDoesNotFit) {
  const auto id = queue().submit(answering(std::string(2 << 20, 'x'))).record.id;
  const auto status = wait_until_finished(id);
  EXPECT_EQ(status.record.state, JobState::failed);
  EXPECT_EQ(status.record.error_status, 507);
  EXPECT_NE(status.record.error.find("store.full"), std::string::npos) << status.record.error;
  EXPECT_EQ(store_->jobs().job(id)->state, JobState::failed) << "the reason does fit";
  EXPECT_EQ(logged_, 1);
  EXPECT_TRUE(fs::is_empty(folder_ / "results"));
}

TEST_F(FullDiskTest, HoldsTheEndOfAJobUntilThereIsSpaceAgain) {
  const auto id = queue().submit(waiting()).record.id;
  wait_until_started();
  disk_->fill();
  open_ = true;
  const auto status = wait_until_finished(id);
  EXPECT_EQ(status.record.state, JobState::failed);
  EXPECT_NE(status.record.error.find("store.full"), std::string::npos) << status.record.error;
  EXPECT_EQ(store_->jobs().job(id)->state, JobState::running) << "the disk is full";
  EXPECT_GE(logged_, 1);
  EXPECT_TRUE(in_list(JobState::failed, id));
  EXPECT_TRUE(in_list(std::nullopt, id));
  EXPECT_FALSE(in_list(JobState::accepted, id));
  EXPECT_FALSE(in_list(JobState::running, id));
  EXPECT_FALSE(queue().mesh_in_use("mesh"));
  disk_->make_space();
  for (int i = 0; i < 500 && store_->jobs().job(id)->state == JobState::running; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(store_->jobs().job(id)->state, JobState::failed) << "written once there is space";
  EXPECT_EQ(queue().status(id).record.error, status.record.error);
  EXPECT_EQ(queue().status(id).record.finished, status.record.finished);
  queue_.reset();
  start();
  EXPECT_EQ(queue().status(id).record.error, status.record.error) << "a restart agrees";
}

TEST_F(FullDiskTest, KeepsADismissedJobDismissed) {
  const auto id = queue().submit(endless()).record.id;
  wait_until_started();
  disk_->fill();
  EXPECT_EQ(queue().remove(id)->record.state, JobState::dismissed);
  EXPECT_EQ(queue().status(id).record.state, JobState::dismissed);
  disk_->make_space();
  EXPECT_FALSE(queue().remove(id)) << "a finished job is removed";
  EXPECT_EQ(code_of([&] { queue().status(id); }), "job.not_found");
}

}  // namespace
}  // namespace supple::jobs
