#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "supple/store/local_store.h"

namespace supple::jobs {

/// The jobs of another store. A test can delay each call that writes, or make it fail.
class HookedJobs final : public store::JobStore {
 public:
  explicit HookedJobs(store::JobStore& real) : real_(real) {}

  bool add_job(const store::JobRecord& job, const std::string& request) override {
    if (at_add) at_add(job);
    return real_.add_job(job, request);
  }
  bool update_job(const store::JobRecord& job) override {
    if (at_update) at_update(job);
    return real_.update_job(job);
  }
  bool finish_job(const store::JobRecord& job, const store::Result* result) override {
    if (at_finish) at_finish(job, result);
    return real_.finish_job(job, result);
  }
  std::optional<store::JobRecord> job(const std::string& id) const override { return real_.job(id); }
  std::vector<store::JobRecord> jobs(const std::vector<store::JobState>& states, std::size_t limit,
                                     const std::string& after, const std::string& owner) const override {
    return real_.jobs(states, limit, after, owner);
  }
  std::optional<store::JobRecord> job_of_key(const std::string& key) const override { return real_.job_of_key(key); }
  bool owns_job(const std::string& id, const std::string& owner) const override { return real_.owns_job(id, owner); }
  bool remove_job(const std::string& id) override { return real_.remove_job(id); }
  std::vector<store::JobRecord> unfinished_jobs() const override { return real_.unfinished_jobs(); }
  std::size_t remove_expired_jobs(std::int64_t now, std::size_t max_count) override {
    return real_.remove_expired_jobs(now, max_count);
  }

  std::function<void(const store::JobRecord&)> at_add;
  std::function<void(const store::JobRecord&)> at_update;
  std::function<void(const store::JobRecord&, const store::Result*)> at_finish;

 private:
  store::JobStore& real_;
};

/// Leases of one server, to which all unfinished jobs are leased unless the test says otherwise.
class OwnLeases final : public store::LeaseStore {
 public:
  explicit OwnLeases(const store::JobStore& jobs) : jobs_(jobs) {}

  std::vector<store::LeasedJob> renew_leases(const std::vector<store::JobProgress>& running) override {
    if (at_renewal) at_renewal(running);
    std::vector<store::LeasedJob> leased;
    if (is_leased && !is_leased()) return leased;
    for (const auto& job : jobs_.unfinished_jobs()) leased.push_back({job.id, job.fencing_token});
    return leased;
  }
  std::vector<store::JobRecord> lease_jobs(const store::IdleWorkers&) override { return {}; }
  std::optional<store::JobProgress> job_progress(const std::string&) const override { return std::nullopt; }
  std::optional<store::JobRecord> dismiss_job(const std::string&, std::int64_t, std::int64_t) override {
    return std::nullopt;
  }
  bool has_unfinished_job_on(const std::string&) const override { return false; }

  std::function<void(const std::vector<store::JobProgress>&)> at_renewal;
  std::function<bool()> is_leased;  ///< may be empty

 private:
  const store::JobStore& jobs_;
};

/// A local store with such jobs, and with leases if the test gives it some.
class TestStore final : public store::Store {
 public:
  explicit TestStore(const std::filesystem::path& folder) : real_(folder), hooked_jobs(real_.jobs()) {}
  store::MeshStore& meshes() const override { return real_.meshes(); }
  store::FamilyStore& families() const override { return real_.families(); }
  store::JobStore& jobs() const override { return hooked_jobs; }
  store::BlobStore& blobs() const override { return real_.blobs(); }
  store::LeaseStore* leases() const override { return own_leases ? &*own_leases : nullptr; }
  void refill_reserve() override { real_.refill_reserve(); }
  store::Usage usage() const override { return real_.usage(); }

 private:
  store::LocalStore real_;

 public:
  mutable HookedJobs hooked_jobs;
  mutable std::optional<OwnLeases> own_leases;
};

}  // namespace supple::jobs
