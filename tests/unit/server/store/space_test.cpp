#include <thread>

#include "store_fixture.h"
#include "supple/problem/problem.h"
#include "unit/server/thrown_problem.h"

namespace supple::store {
namespace {

/// Tests of stores with a quota.
class QuotaTest : public StoreTest {
 protected:
  /// Adds a job that has ended with a result of so many bytes.
  static void add_ended(Store& store, const std::string& id, std::size_t bytes) {
    auto job = new_job(id);
    store.jobs().add_job(job);
    job.state = JobState::successful;
    job.finished = now_milliseconds();
    job.expires = job.finished + 1'000'000;
    const Result result{"text/plain", {}, std::string(bytes, 'x')};
    store.jobs().finish_job(job, &result);
  }
  /// Bytes of all files in the folder, by their sizes on disk.
  std::int64_t on_disk() const {
    std::int64_t sum = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      if (entry.is_regular_file()) sum += static_cast<std::int64_t>(entry.file_size());
    return sum;
  }
};

TEST_F(QuotaTest, CountsTheBytesOfTheFolderExactly) {
  const auto expect_exact = [&](const Store& store, const char* when) {
    const auto usage = store.usage();
    EXPECT_EQ(usage.total(), on_disk()) << when;
    EXPECT_EQ(usage.limit, 0);
  };
  {
    LocalStore store(folder_, recovery());
    expect_exact(store, "new");
    const auto mesh = store.meshes().add_mesh(std::string(1000, 'm'), describe).first.id;
    store.meshes().add_mesh(std::string(1000, 'm'), describe);
    EXPECT_EQ(store.usage().meshes, 1000);
    std::ofstream(folder_ / "meshes" / (mesh + ".ply")) << "damaged";
    store.meshes().add_mesh(std::string(1000, 'm'), describe);
    add_ended(store, "kept", 5000);
    add_ended(store, "removed", 5000);
    store.jobs().remove_job("removed");
    for (const std::size_t bytes : {300, 300'000}) {
      const auto job = new_job("waits" + std::to_string(bytes));
      store.jobs().add_job(job, store.blobs().store_request(job, {"POST", "/x", {}, {}, {}}, std::string(bytes, 'r')));
      store.blobs().store_request(new_job("dropped"), {"POST", "/x", {}, {}, {}}, std::string(bytes, 'r'));
      store.blobs().remove_request("dropped");
    }
    store.meshes().add_mesh("gone", describe);
    store.meshes().remove_mesh(sha256("gone"));
    EXPECT_THROW(store.meshes().add_mesh("cannot be described",
                                         [](const auto&, auto) -> std::string { throw Error("mesh.malformed", "x"); }),
                 Error);
    EXPECT_GT(store.usage().results, 5000);
    EXPECT_GT(store.usage().requests, 300'000);
    EXPECT_LT(store.usage().requests, 302'000);
    expect_exact(store, "used");
  }
  std::ofstream(folder_ / "meshes" / "unknown") << "into quarantine";
  const std::string content(1000, 'm');
  std::ofstream(folder_ / "meshes" / (sha256(content) + ".ply")) << "damaged";
  LocalStore store(folder_, recovery());
  EXPECT_EQ(store.usage().quarantine, 15);
  expect_exact(store, "opened again");
  EXPECT_EQ(store.usage().meshes, 7);
  store.meshes().add_mesh(content, describe);
  EXPECT_EQ(store.usage().meshes, 1000);
  expect_exact(store, "after the damaged mesh was repaired");
  fs::remove_all(folder_ / "quarantine");
  store.jobs().remove_expired_jobs(0, 100);
  expect_exact(store, "after the quarantine was emptied");
}

TEST_F(QuotaTest, ExpiresTheOldestResultsForWhatIsNew) {
  constexpr std::int64_t result = 1 << 20;
  constexpr std::int64_t limit = 5 * result;  // room for three results, and for the database with its log
  LocalStore store(folder_, recovery(), {limit, 0});
  for (int i = 0; i < 6; ++i) {
    add_ended(store, "j" + std::to_string(i), result);
    EXPECT_LE(store.usage().total(), limit);
  }
  EXPECT_FALSE(store.jobs().job("j0"));
  EXPECT_FALSE(store.jobs().job("j1"));
  EXPECT_TRUE(store.jobs().job("j4"));
  EXPECT_EQ(store.blobs().job_result("j5").body.size(), static_cast<std::size_t>(result));
  store.jobs().add_job(new_job("unfinished"));
  store.meshes().add_mesh(std::string(4 * result, 'm'), describe);
  EXPECT_FALSE(store.jobs().job("j5")) << "a mesh is worth more than results";
  EXPECT_TRUE(store.jobs().job("unfinished"));
  EXPECT_LE(store.usage().total(), limit);
}

TEST_F(QuotaTest, RefusesWhatHasNoRoomAndNamesNumberLimitAndSetting) {
  constexpr std::int64_t limit = 4 << 20;
  LocalStore store(folder_, recovery(), {limit, 0});
  add_ended(store, "j", 1 << 20);
  const auto refused = thrown_problem([&] { store.meshes().add_mesh(std::string(limit, 'm'), describe); });
  EXPECT_EQ(refused.code, "store.quota");
  ASSERT_TRUE(refused.limit);
  EXPECT_EQ(refused.limit->limit, limit);
  EXPECT_GT(refused.limit->value, limit);
  EXPECT_EQ(refused.limit->setting, "--max-store");
  EXPECT_NE(refused.detail.find("mesh of " + std::to_string(limit) + " bytes"), std::string::npos) << refused.detail;
  EXPECT_TRUE(store.jobs().job("j")) << "nothing goes in vain";
  auto job = new_job("large");
  store.jobs().add_job(job);
  job.state = JobState::successful;
  const Result large{"text/plain", {}, std::string(limit, 'x')};
  EXPECT_EQ(thrown_problem([&] { store.jobs().finish_job(job, &large); }).code, "store.quota");
  EXPECT_EQ(thrown_problem([&] {
              store.blobs().store_request(job, {"POST", "/x", {}, {}, {}}, std::string(limit, 'r'));
            }).code,
            "store.quota");
  EXPECT_LT(store.usage().total(), limit) << "what was refused takes nothing";
}

TEST_F(QuotaTest, LimitsTheBytesOfMeshes) {
  LocalStore store(folder_, recovery(), {0, 1500});
  store.meshes().add_mesh(std::string(1000, 'a'), describe);
  const auto refused = thrown_problem([&] { store.meshes().add_mesh(std::string(501, 'b'), describe); });
  EXPECT_EQ(refused.code, "store.quota");
  EXPECT_EQ(refused.limit->setting, "--max-mesh-bytes");
  EXPECT_EQ(refused.limit->value, 1501);
  store.meshes().add_mesh(std::string(500, 'b'), describe);
  store.meshes().remove_mesh(sha256(std::string(1000, 'a')));
  store.meshes().add_mesh(std::string(1000, 'c'), describe);
  EXPECT_EQ(store.usage().meshes, 1500);
}

TEST_F(QuotaTest, RemovesMeshesThatNobodyUses) {
  {
    LocalStore store(folder_);
    for (const char* ply : {"unused", "used", "worked on"}) store.meshes().add_mesh(ply, describe);
    auto job = new_job("j");
    job.mesh = sha256("worked on");
    store.jobs().add_job(job);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  const auto later = now_milliseconds();
  {
    LocalStore store(folder_);
    store.meshes().note_mesh_use(sha256("used"));
  }
  LocalStore store(folder_);
  EXPECT_TRUE(store.meshes().remove_unused_meshes(0).empty());
  EXPECT_EQ(store.meshes().remove_unused_meshes(later), std::vector{sha256("unused")});
  EXPECT_EQ(store.meshes().meshes(10, "").size(), 2U);
  EXPECT_EQ(store.usage().meshes, 13);
  store.jobs().remove_job("j");
  EXPECT_EQ(store.meshes().remove_unused_meshes(later), std::vector{sha256("worked on")});
}

}  // namespace
}  // namespace supple::store
