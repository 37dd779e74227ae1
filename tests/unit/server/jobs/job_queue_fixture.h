#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "supple/budget/memory.h"
#include "supple/jobs/job_queue.h"
#include "supple/json/answers.h"
#include "supple/store/local_store.h"
#include "support/temporary_folder.h"
#include "unit/server/thrown_problem.h"

namespace supple::jobs {

namespace fs = std::filesystem;
using store::JobState;

/// Tests of jobs over a local store in a temporary folder.
class JobTest : public ::testing::Test {
 protected:
  static Computation computation(std::function<store::Result(const Execution&)> run, double deadline = 60) {
    return {"geodesics", "mesh", deadline, std::move(run)};
  }
  /// The code of the problem that a client is told of what `call` throws.
  template <typename Call>
  static std::string code_of(Call&& call) {
    return thrown_problem(std::forward<Call>(call)).code;
  }

  const testing::TemporaryFolder temporary_folder_;
  const fs::path folder_ = temporary_folder_.path();
  std::unique_ptr<store::Store> store_ = std::make_unique<store::LocalStore>(folder_);
  QueueOptions options_{.workers = 1};
};

/// Tests of a queue.
class JobQueueTest : public JobTest {
 protected:
  ~JobQueueTest() override { queue_.reset(); }

  JobQueue& queue() {
    if (!queue_)
      queue_ = std::make_unique<JobQueue>(
          *store_, options_, json::write_problem, [](const store::JobRecord&) {}, JobQueue::Log{}, remake_);
    return *queue_;
  }

  static Computation answering(const std::string& body) {
    return computation([body](const Execution&) { return store::Result{"text/plain", {}, body}; });
  }
  /// Runs until it is stopped.
  Computation endless(double deadline = 60) {
    return computation(
        [this](const Execution& execution) -> store::Result {
          ++started_;
          while (true) {
            execution.checkpoint(0.5, "spinning");
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
          }
        },
        deadline);
  }

  JobStatus wait_until_finished(const std::string& id) {
    std::uint64_t version = 0;
    for (int i = 0; i < 1000; ++i) {
      const auto status = queue().wait_for_change(id, version, 0.1);
      if (status.record.finished) return status;
    }
    ADD_FAILURE() << "the job does not finish";
    return {};
  }
  void wait_until_started(int count = 1) {
    while (started_ < count) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  /// Ends the queue in good order, and makes one over the same folder as the next process does.
  JobQueue& restart() {
    queue_.reset();
    store_.reset();
    store_ = std::make_unique<store::LocalStore>(folder_);
    started_ = 0;
    return queue();
  }
  /// Leaves a job in the store as a process does that is killed during the job's attempt of this number.
  void leave_running(const std::string& id, int attempts, const std::string& body) {
    store::JobRecord job;
    job.id = id;
    job.kind = "geodesics";
    job.deadline = 60;
    job.state = JobState::running;
    job.started = 1;
    job.attempts = attempts;
    store_->jobs().add_job(job, store_->blobs().store_request(job, {"POST", "/v1/" + body, {}, {}, {}}, body));
  }
  static RequestOfJob request(std::string_view body) { return {{"POST", "/v1/x", {}, "text/plain", {}}, body}; }
  /// Answers with the body of the request.
  static Computation echo(const store::JobRecord&, const store::StoredRequest& stored, const Execution&) {
    return computation([body = stored.body](const Execution&) { return store::Result{"text/plain", {}, body}; });
  }

  budget::MemoryBudget memory_{256 << 20, 64 << 20};  ///< outlives the queue, whose watchdog uses it
  JobQueue::Remake remake_;
  std::unique_ptr<JobQueue> queue_;
  std::atomic<int> started_{0};
};

}  // namespace supple::jobs
