#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "shared_store_fixture.h"

namespace supple::store {
namespace {

TEST_F(SharedStoreTest, RemovesWhatHasExpiredAndWhatNobodyUses) {
  SharedStore store(options());
  const Result result{"text/plain", {}, "answer"};
  for (const char* id : {"old", "older", "new"}) {
    auto job = ended(running(store, id));
    if (std::string(id) == "old") job.expires = 10;
    store.jobs().finish_job(job, &result);
  }
  running(store, "unfinished");
  EXPECT_EQ(store.jobs().remove_expired_jobs(11, 100), 1U);
  EXPECT_FALSE(store.jobs().job("old").has_value());
  EXPECT_EQ(store.jobs().remove_expired_jobs(11, 1), 1U) << "beyond the most that are kept";
  EXPECT_TRUE(store.jobs().job("new").has_value());
  EXPECT_TRUE(store.jobs().job("unfinished").has_value());
  EXPECT_EQ(files_in(folder_ / "data" / "results"), 1U);

  const auto used = store.meshes().add_mesh("used", describe).first.id;
  const auto unused = store.meshes().add_mesh("unused", describe).first.id;
  const auto busy = store.meshes().add_mesh("busy", describe).first.id;
  auto job = new_job("works on it");
  job.mesh = busy;
  store.jobs().add_job(job);
  EXPECT_TRUE(store.leases()->has_unfinished_job_on(busy));
  EXPECT_FALSE(store.leases()->has_unfinished_job_on(used));
  wait_milliseconds(20);
  const auto before = now_milliseconds();
  wait_milliseconds(20);
  store.meshes().note_mesh_use(used);
  EXPECT_EQ(store.meshes().remove_unused_meshes(before), std::vector<std::string>{unused});
  EXPECT_EQ(store.meshes().mesh_content(used), "used");
  EXPECT_EQ(files_in(folder_ / "data" / "meshes"), 2U);
  store.jobs().finish_job(ended(job), nullptr);
  EXPECT_FALSE(store.leases()->has_unfinished_job_on(busy));
}

TEST_F(SharedStoreTest, ExpiresTheOldestResultsForWhatIsNewAndRefusesWhatDoesNotFit) {
  {
    const SharedStore empty(options());
    quota_.bytes = empty.usage().database + (1 << 20);
  }
  SharedStore store(options());
  const Result large{"text/plain", {}, std::string(600'000, 'x')};
  EXPECT_TRUE(store.jobs().finish_job(ended(running(store, "first")), &large));
  EXPECT_TRUE(store.jobs().finish_job(ended(running(store, "second")), &large));
  EXPECT_FALSE(store.jobs().job("first").has_value());
  EXPECT_TRUE(store.jobs().job("second").has_value());
  EXPECT_EQ(warnings_.size(), 1U);
  EXPECT_EQ(code_of([&] { store.meshes().add_mesh(std::string(2'000'000, 'm'), describe); }), "store.quota");
  EXPECT_TRUE(store.jobs().job("second").has_value()) << "no result goes for what would not fit without it either";
}

TEST_F(SharedStoreTest, RefusesAMeshBeyondTheLimitOfItsOwner) {
  quota_.owner_limit = [](const std::string& owner) { return owner == "alice" ? 1000 : 0; };
  SharedStore store(options());
  EXPECT_EQ(code_of([&] { store.meshes().add_mesh(std::string(1001, 'm'), describe, "alice"); }), "store.key_quota");
  EXPECT_TRUE(store.meshes().add_mesh(std::string(1001, 'm'), describe, "bob").second);
  EXPECT_EQ(code_of([&] { store.meshes().add_mesh(std::string(1001, 'm'), describe, "alice"); }), "store.key_quota");
}

TEST_F(SharedStoreTest, CountsWhatItStores) {
  SharedStore store(options());
  const auto large_request = [&](const std::string& id) {
    const auto job = new_job(id);
    store.jobs().add_job(
        job, store.blobs().store_request(job, {"POST", "/v1/x", {}, "text/plain", "*/*"}, std::string(300'000, 'x')));
    return job;
  };
  const auto id = store.meshes().add_mesh("four", describe, "alice").first.id;
  store.meshes().add_mesh("four", describe, "bob");
  const auto job = large_request("job");
  const auto small = new_job("small");  // its request is in the database
  store.jobs().add_job(small, store.blobs().store_request(small, {"POST", "/v1/x", {}, "text/plain", "*/*"}, "x"));
  const Result result{"text/plain", {}, std::string(1000, 'x')};
  store.jobs().finish_job(ended(running(store, "other")), &result);
  const auto counted = [&] { return SharedStore(options()).usage(); };  // counted by a new server from the database
  const auto expect_counted = [&] {
    EXPECT_EQ(store.usage().meshes, counted().meshes);
    EXPECT_EQ(store.usage().results, counted().results);
    EXPECT_EQ(store.usage().requests, counted().requests);
  };
  EXPECT_EQ(store.usage().meshes, 4) << "of two owners once";
  EXPECT_GT(store.usage().results, 1000);
  EXPECT_GT(store.usage().requests, 300'000);
  expect_counted();
  store.meshes().remove_mesh(id, "alice");
  EXPECT_EQ(store.usage().meshes, 4);
  store.meshes().remove_mesh(id, "bob");
  store.jobs().remove_job("other");
  EXPECT_EQ(store.usage().results, 0);
  EXPECT_EQ(store.usage().meshes, 0);
  expect_counted();
  store.meshes().add_mesh("nobody uses it", describe);
  EXPECT_EQ(store.meshes().remove_unused_meshes(now_milliseconds() + 1000).size(), 1U);
  EXPECT_EQ(store.usage().meshes, 0);
  expect_counted();
}

TEST_F(SharedStoreTest, ManyThreadsRemoveWhatHasExpired) {
  orphan_age_ = 0.001;  // seconds: nearly every call looks for orphaned files
  SharedStore store(options());
  const Result result{"text/plain", {}, "answer"};
  for (int i = 0; i < 20; ++i) {
    auto job = ended(running(store, "job" + std::to_string(i)));
    job.expires = 10;
    EXPECT_TRUE(store.jobs().finish_job(job, &result));
  }
  // An old file would count as orphaned between the removal of its row and its own.
  for (const auto& file : fs::directory_iterator(in_data("results")))
    fs::last_write_time(file, fs::file_time_type::clock::now() + std::chrono::hours(1));
  std::atomic<std::size_t> removed{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int j = 0; j < 20; ++j) removed += store.jobs().remove_expired_jobs(10, 100);
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(removed, 20U);
  EXPECT_EQ(files_in(in_data("results")), 0U);
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(SharedStoreTest, RefusesNothingAndExpiresNothingForWhatAnotherServerHasRemoved) {
  {
    const SharedStore empty(options());
    quota_.bytes = empty.usage().database + (1 << 20);
    quota_.mesh_bytes = 1000;
  }
  SharedStore one(options());
  SharedStore two(options());
  const Result large{"text/plain", {}, std::string(400'000, 'x')};
  EXPECT_TRUE(one.jobs().finish_job(ended(running(one, "kept")), &large));
  EXPECT_TRUE(one.jobs().finish_job(ended(running(one, "removed")), &large));
  const auto mesh = one.meshes().add_mesh(std::string(600, 'm'), describe).first.id;
  EXPECT_TRUE(two.jobs().remove_job("removed"));
  EXPECT_TRUE(two.meshes().remove_mesh(mesh));
  EXPECT_TRUE(one.meshes().add_mesh(std::string(700, 'n'), describe).second);
  EXPECT_TRUE(one.jobs().finish_job(ended(running(one, "new")), &large));
  EXPECT_TRUE(one.jobs().job("kept").has_value());
}

TEST_F(SharedStoreTest, ExpiresTheResultsOfAnOwnerForWhatIsNewOfIt) {
  quota_.owner_limit = [](const std::string& owner) { return owner == "alice" ? 3000 : 0; };
  SharedStore store(options());
  const Result result{"text/plain", {}, std::string(1200, 'x')};
  const auto finish = [&](const std::string& id, const std::string& owner) {
    auto job = new_job(id, owner);
    // The request of the job is removed at its end, which makes room for the result.
    store.jobs().add_job(
        job, store.blobs().store_request(job, {"POST", "/v1/x", {}, "text/plain", "*/*"}, std::string(1200, 'r')));
    return store.jobs().finish_job(ended(job), &result);
  };
  EXPECT_TRUE(finish("of bob", "bob"));
  EXPECT_TRUE(finish("first", "alice"));
  EXPECT_TRUE(store.jobs().job("first").has_value()) << "a result and a request fit";
  EXPECT_TRUE(finish("second", "alice"));
  EXPECT_FALSE(store.jobs().job("first").has_value());
  EXPECT_TRUE(store.jobs().job("second").has_value());
  EXPECT_TRUE(store.jobs().job("of bob").has_value()) << "it is older, and another's";
  EXPECT_EQ(code_of([&] { store.meshes().add_mesh(std::string(3001, 'm'), describe, "alice"); }), "store.key_quota");
  EXPECT_TRUE(store.jobs().job("second").has_value()) << "no result goes for what would not fit without it either";
}

TEST_F(SharedStoreTest, CountsAnewWhatOthersHaveAdded) {
  recount_interval_ = 0.5;
  SharedStore one(options());
  SharedStore two(options());
  two.meshes().add_mesh("mesh", describe);
  one.leases()->renew_leases({});
  EXPECT_EQ(one.usage().meshes, 0) << "it counted when it was made";
  wait_milliseconds(600);
  one.leases()->renew_leases({});
  EXPECT_EQ(one.usage().meshes, 4);
}

TEST_F(SharedStoreTest, MovesWhatNobodyKnowsIntoQuarantine) {
  orphan_age_ = 1;
  SharedStore store(options());
  const Result result{"text/plain", {}, "answer"};
  store.jobs().finish_job(ended(running(store, "ended")), &result);
  const auto mesh = store.meshes().add_mesh("mesh", describe).first.id;
  const auto job = new_job("waits");
  store.jobs().add_job(
      job, store.blobs().store_request(job, {"POST", "/v1/x", {}, "text/plain", "*/*"}, std::string(300'000, 'x')));
  overwrite("meshes/unknown.ply", "a mesh");
  overwrite("meshes/" + mesh + ".txt", "no mesh");
  overwrite("results/ended.7.result", "of another lease");
  overwrite("requests/ended.request", "of a job that has ended");
  overwrite("results/lost.0.result.0.part", "half-written by a server that was lost");
  wait_milliseconds(1100);
  overwrite("results/young.0.result", "about to be known");
  overwrite("results/young.1.result.0.part", "being written");
  store.jobs().remove_expired_jobs(0, 100);
  EXPECT_FALSE(fs::exists(in_data("results/lost.0.result.0.part")));
  EXPECT_TRUE(fs::exists(in_data("results/young.1.result.0.part")));
  EXPECT_EQ(quarantined_in(in_data("quarantine")),
            (std::multiset<std::string>{"a mesh", "no mesh", "of another lease", "of a job that has ended"}));
  EXPECT_EQ(store.meshes().mesh_content(mesh), "mesh");
  EXPECT_EQ(store.blobs().job_result("ended").body.text(), "answer");
  EXPECT_EQ(store.blobs().job_request("waits").body.size(), 300'000U);
  EXPECT_TRUE(fs::exists(in_data("results/young.0.result")));
  fs::last_write_time(in_data("results/young.0.result"), fs::file_time_type::clock::now() - std::chrono::hours(1));
  store.jobs().remove_expired_jobs(0, 100);
  EXPECT_TRUE(fs::exists(in_data("results/young.0.result"))) << "it has just looked";
}

}  // namespace
}  // namespace supple::store
