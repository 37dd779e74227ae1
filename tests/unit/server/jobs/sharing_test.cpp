#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "supple/base/error.h"
#include "supple/jobs/job_queue.h"
#include "supple/json/answers.h"
#include "supple/store/shared_store.h"
#include "support/private_postgres.h"

namespace supple::jobs {
namespace {

using store::JobState;
using testing::PrivatePostgres;
using testing::TemporaryFolder;

/// The computations of all servers.
struct Work {
  std::mutex mutex;
  std::map<std::string, int> completed;  ///< number of times that each request was computed to its end
  std::atomic<int> running{0};
  std::atomic<bool> go_on{true};  ///< whether computations of the request "waits" end
};

/// A server without HTTP: a queue over its store.
class Server {
 public:
  Server(const std::string& database, const std::filesystem::path& folder, Work& work, double lease = 2)
      : work_(work), store_(options_of_store(database, folder, lease)) {
    options_.workers = 1;
    queue_ = std::make_unique<JobQueue>(
        store_, options_, json::write_problem, [](const store::JobRecord&) {}, JobQueue::Log{},
        [this](const store::JobRecord&, const store::StoredRequest& stored, const Execution&) {
          return computation(stored.body);
        });
  }

  JobQueue& queue() { return *queue_; }
  std::string submit(const std::string& body, const std::string& key = {}) {
    auto work = computation(body);
    work.idempotency_key = key;
    work.request_hash = body;
    return queue_->submit(std::move(work), RequestOfJob{{"POST", "/v1/x", {}, "text/plain", {}}, body}).record.id;
  }
  JobStatus wait_until(const std::string& id, JobState state, double seconds = 60) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (true) {
      auto status = queue_->status(id);
      if (status.record.state == state || std::chrono::steady_clock::now() > end) return status;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

 private:
  static store::SharedStore::Options options_of_store(const std::string& database, const std::filesystem::path& folder,
                                                      double lease) {
    store::SharedStore::Options options;
    options.database = database;
    options.folder = folder;
    options.lease = lease;
    return options;
  }
  /// Answers with the request, which is "waits" for a computation that waits for the test.
  Computation computation(const std::string& body) {
    return {"geodesics", "mesh", 60, [this, body](const Execution& execution) {
              ++work_.running;
              try {
                while (body == "waits" && !work_.go_on) {
                  execution.checkpoint(0.5, "waiting");
                  std::this_thread::sleep_for(std::chrono::milliseconds(1));
                }
              } catch (...) {
                --work_.running;
                throw;
              }
              --work_.running;
              const std::lock_guard lock(work_.mutex);
              ++work_.completed[body];
              return store::Result{"text/plain", {}, body};
            }};
  }

  Work& work_;
  store::SharedStore store_;
  QueueOptions options_;
  std::unique_ptr<JobQueue> queue_;
};

class SharingTest : public ::testing::Test {
 protected:
  std::unique_ptr<Server> server(double lease = 2) {
    return std::make_unique<Server>(database_, folder_ / "data", work_, lease);
  }
  void wait_until_running(int count) {
    while (work_.running < count) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  const std::string database_ = PrivatePostgres::of_this_process().new_database();
  const TemporaryFolder folder_;
  Work work_;
};

TEST_F(SharingTest, GivesJobsThatWaitToAServerThatHasNothingToDo) {
  work_.go_on = false;
  const auto busy = server();
  const auto running = busy->submit("waits");
  wait_until_running(1);
  std::vector<std::string> waiting;
  for (int i = 0; i < 5; ++i) waiting.push_back(busy->submit("job" + std::to_string(i)));
  const auto idle = server();
  for (const auto& id : waiting)
    EXPECT_EQ(idle->wait_until(id, JobState::successful).record.state, JobState::successful);
  EXPECT_EQ(busy->queue().list(JobState::successful, 10, {}).size(), waiting.size())
      << "seen at its own server at once";
  for (const auto& id : waiting) {
    EXPECT_EQ(busy->queue().result(id).body.text().substr(0, 3), "job");
  }
  EXPECT_EQ(busy->queue().status(running).record.state, JobState::running);
  work_.go_on = true;
  EXPECT_EQ(idle->wait_until(running, JobState::successful).record.state, JobState::successful);
  EXPECT_EQ(idle->queue().result(running).body.text(), "waits");
  for (const auto& [body, times] : work_.completed) EXPECT_EQ(times, 1) << body;
  EXPECT_EQ(work_.completed.size(), 6U);
}

TEST_F(SharingTest, TellsHowFarAJobOfAnotherServerIs) {
  work_.go_on = false;
  const auto one = server();
  const auto id = one->submit("waits");
  wait_until_running(1);
  const auto two = server();  // it starts late, since it would have taken a job that waits
  std::uint64_t version = 0;
  JobStatus status;
  for (int i = 0; i < 50 && status.stage.empty(); ++i) status = two->queue().wait_for_change(id, version, 0.3);
  EXPECT_EQ(status.stage, "waiting");
  EXPECT_EQ(status.progress, 0.5);
  EXPECT_EQ(two->queue().list(JobState::running, 10, {}).at(0).stage, "waiting");
  EXPECT_TRUE(two->queue().mesh_in_use("mesh"));
  work_.go_on = true;
  while (!status.record.finished) status = two->queue().wait_for_change(id, version, 1);
  EXPECT_EQ(status.record.state, JobState::successful);
  EXPECT_FALSE(two->queue().mesh_in_use("mesh"));
}

TEST_F(SharingTest, DismissesAJobOfAnotherServer) {
  work_.go_on = false;
  const auto one = server();
  const auto id = one->submit("waits");
  wait_until_running(1);
  const auto two = server();  // it starts late, since it would have taken a job that waits
  const auto dismissed = two->queue().remove(id);
  ASSERT_TRUE(dismissed);
  EXPECT_EQ(dismissed->record.state, JobState::dismissed);
  for (int i = 0; i < 5000 && work_.running > 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(work_.running, 0) << "it is stopped where it runs";
  EXPECT_EQ(one->queue().status(id).record.state, JobState::dismissed);
  EXPECT_FALSE(one->queue().remove(id)) << "and can be removed";
  EXPECT_THROW(two->queue().status(id), Error);
}

TEST_F(SharingTest, MakesOneJobOfTwoRequestsWithOneKey) {
  const auto one = server();
  const auto two = server();
  const auto id = one->submit("job", "key");
  EXPECT_EQ(two->submit("job", "key"), id);
  EXPECT_EQ(one->submit("job", "key"), id);
  EXPECT_NE(one->submit("job", "another key"), id);
  EXPECT_THROW(two->submit("something else", "key"), Error);
  std::vector<std::thread> threads;
  std::mutex mutex;
  std::vector<std::string> ids;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&, i] {
      const auto given = (i % 2 ? *one : *two).submit("at once", "the same key");
      const std::lock_guard lock(mutex);
      ids.push_back(given);
    });
  }
  for (auto& thread : threads) thread.join();
  for (const auto& given : ids) EXPECT_EQ(given, ids[0]);
  EXPECT_EQ(two->wait_until(ids[0], JobState::successful).record.state, JobState::successful);
  EXPECT_EQ(work_.completed["at once"], 1);
}

TEST_F(SharingTest, LeavesJobsToOthersAtItsEnd) {
  work_.go_on = false;
  auto ends = server();
  const auto running = ends->submit("waits");
  wait_until_running(1);
  const auto waiting = ends->submit("job");
  ends->queue().shut_down(0);
  const auto other = server();
  EXPECT_EQ(other->wait_until(running, JobState::running).record.attempts, 1) << "an end in good order is no attempt";
  work_.go_on = true;
  for (const auto& id : {running, waiting})
    EXPECT_EQ(other->wait_until(id, JobState::successful).record.state, JobState::successful);
}

TEST_F(SharingTest, RunsJobsAgainWhoseServerIsLost) {
  // A store without a queue is a server that has jobs and does not renew its leases.
  store::SharedStore::Options options;
  options.database = database_;
  options.folder = folder_ / "data";
  options.lease = 0.1;
  store::SharedStore lost(options);
  store::JobRecord job;
  job.id = "lost";
  job.kind = "geodesics";
  job.deadline = 60;
  lost.jobs().add_job(job, lost.blobs().store_request(job, {"POST", "/v1/x", {}, "text/plain", {}}, "body"));
  job.state = JobState::running;
  job.attempts = 1;
  EXPECT_TRUE(lost.jobs().update_job(job));
  job.id = "given up";
  job.state = JobState::accepted;
  lost.jobs().add_job(job, lost.blobs().store_request(job, {"POST", "/v1/x", {}, "text/plain", {}}, "body"));
  job.state = JobState::running;
  job.attempts = 3;
  EXPECT_TRUE(lost.jobs().update_job(job));

  const auto other = server();
  EXPECT_EQ(other->wait_until("lost", JobState::successful).record.state, JobState::successful);
  EXPECT_EQ(other->queue().status("lost").record.attempts, 2);
  const auto given_up = other->wait_until("given up", JobState::failed);
  EXPECT_EQ(given_up.record.state, JobState::failed);
  EXPECT_NE(given_up.record.error.find("job.given_up"), std::string::npos);
}

TEST_F(SharingTest, RunsJobsAgainThatEndedWhileTheDatabaseWasAway) {
  work_.go_on = false;
  const auto one = server();
  const auto id = one->submit("waits");
  wait_until_running(1);
  auto& postgres = PrivatePostgres::of_this_process();
  postgres.kill();
  work_.go_on = true;
  for (int i = 0; i < 5000 && work_.running > 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_THROW(one->submit("job"), Error) << "what cannot be kept is not accepted";
  postgres.again();
  EXPECT_EQ(one->wait_until(id, JobState::successful).record.state, JobState::successful);
  EXPECT_EQ(one->queue().result(id).body.text(), "waits");
}

}  // namespace
}  // namespace supple::jobs
