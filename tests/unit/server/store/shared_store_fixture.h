#pragma once

#include <chrono>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "store_fixture.h"
#include "supple/store/shared_store.h"
#include "support/private_postgres.h"

namespace supple::store {

using testing::PrivatePostgres;

/// Tests of several servers with one database and one folder.
class SharedStoreTest : public StoreTest {
 protected:
  SharedStore::Options options(double lease = 60) {
    SharedStore::Options options;
    options.database = database_;
    options.folder = folder_ / "data";
    options.lease = lease;
    options.quota = quota_;
    options.recount_interval = recount_interval_;
    options.orphan_age = orphan_age_;
    options.warn = [this](const std::string& text) { warnings_.push_back(text); };
    return options;
  }
  /// Adds a job that the server runs.
  static JobRecord running(SharedStore& server, const std::string& id) {
    auto job = new_job(id);
    server.jobs().add_job(job, "request");
    job.state = JobState::running;
    job.started = now_milliseconds();
    job.attempts = 1;
    EXPECT_TRUE(server.jobs().update_job(job));
    return job;
  }
  static JobRecord ended(JobRecord job) {
    job.state = JobState::successful;
    job.finished = now_milliseconds();
    job.expires = job.finished + 60'000;
    return job;
  }
  static std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
  }

  static void wait_milliseconds(int time) { std::this_thread::sleep_for(std::chrono::milliseconds(time)); }
  fs::path in_data(const std::string& name) const { return folder_ / "data" / name; }
  void overwrite(const std::string& name, const std::string& content) const {
    std::ofstream(in_data(name), std::ios::binary) << content;
  }

  const std::string database_ = PrivatePostgres::of_this_process().new_database();
  Quota quota_;
  double recount_interval_ = 5;
  double orphan_age_ = 3600;
  std::vector<std::string> warnings_;
};

}  // namespace supple::store
