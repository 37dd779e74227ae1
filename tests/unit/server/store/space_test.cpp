#include <sys/mount.h>

#include <thread>

#include "store_fixture.h"
#include "supple/problem/problem.h"

namespace supple::store {
namespace {

TEST_F(StoreTest, SaysThatTheDiskIsFullAndTakesWritesAgainOnceThereIsSpace) {
  if (::mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=1m") != 0) GTEST_SKIP() << "mounting takes root";
  {
    LocalStore store(folder_);
    auto job = new_job("j");
    store.add_job(job);
    job.state = JobState::successful;
    const Result large{"text/plain", {}, std::string(2 << 20, 'x')};
    EXPECT_EQ(code_of([&] { store.add_mesh(large.body, describe); }), "store.full");
    EXPECT_EQ(code_of([&] { store.finish_job(job, &large); }), "store.full");
    std::ofstream ballast(folder_ / "ballast", std::ios::binary);
    while (ballast.put('x').flush()) {
    }
    EXPECT_EQ(code_of([&] {
                for (int i = 0; i < 1000; ++i) store.add_job(new_job("more" + std::to_string(i)));
              }),
              "store.full")
        << "the database says so too";
    ballast.close();
    fs::remove(folder_ / "ballast");
    const Result small{"text/plain", {}, "x"};
    store.finish_job(job, &small);
    EXPECT_EQ(store.job_result("j").body.text(), "x");
  }
  EXPECT_EQ(::umount(folder_.c_str()), 0);
}

TEST_F(StoreTest, RemovesOnAFullDiskInThePlaceOfItsReserve) {
  if (::mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=1m") != 0) GTEST_SKIP() << "mounting takes root";
  const auto add_expired = [](Store& store, const std::string& id) {
    auto job = new_job(id);
    store.add_job(job);
    job.state = JobState::successful;
    job.finished = 1000;
    job.expires = 1500;
    const Result result{"text/plain", {}, "42"};
    store.finish_job(job, &result);
  };
  const auto fill = [&] {
    std::ofstream ballast(folder_ / "ballast", std::ios::binary | std::ios::app);
    while (ballast.put('x').flush()) {
    }
  };
  {
    LocalStore store(folder_);
    const auto mesh = store.add_mesh("abc", describe).first.id;
    add_expired(store, "j");
    ASSERT_EQ(fs::file_size(folder_ / "reserve"), 256U << 10);
    fs::remove(folder_ / "reserve");
    fill();
    EXPECT_EQ(code_of([&] { store.remove_expired_jobs(2000, 10); }), "store.full") << "without a reserve";
    EXPECT_EQ(store.job_result("j").body.text(), "42") << "the row is still there, and so is its file";
    fs::remove(folder_ / "ballast");
    EXPECT_EQ(store.remove_expired_jobs(2000, 10), 1U);
    EXPECT_TRUE(fs::is_empty(folder_ / "results"));
    const std::vector<std::pair<const char*, std::function<bool()>>> removals{
        {"expired jobs", [&] { return store.remove_expired_jobs(2000, 10) == 1; }},
        {"a job", [&] { return store.remove_job("k"); }},
        {"a mesh", [&] { return store.remove_mesh(mesh); }},
    };
    for (const auto& [name, removal] : removals) {
      store.remove_job("k");
      add_expired(store, "k");
      store.remove_expired_jobs(1000, 10);
      ASSERT_EQ(fs::file_size(folder_ / "reserve"), 256U << 10) << name << ": taken again";
      fill();
      EXPECT_TRUE(removal()) << name;
      fs::remove(folder_ / "ballast");
    }
    EXPECT_FALSE(store.mesh(mesh));
  }
  EXPECT_EQ(::umount(folder_.c_str()), 0);
}

/// Tests of stores with a quota.
class QuotaTest : public StoreTest {
 protected:
  /// Adds a job that has ended with a result of so many bytes.
  static void add_ended(Store& store, const std::string& id, std::size_t bytes) {
    auto job = new_job(id);
    store.add_job(job);
    job.state = JobState::successful;
    job.finished = now_milliseconds();
    job.expires = job.finished + 1'000'000;
    const Result result{"text/plain", {}, std::string(bytes, 'x')};
    store.finish_job(job, &result);
  }
  /// Bytes of all files in the folder, by their sizes on disk.
  std::int64_t on_disk() const {
    std::int64_t sum = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      if (entry.is_regular_file()) sum += static_cast<std::int64_t>(entry.file_size());
    return sum;
  }
  static problem::Problem problem_of(const std::function<void()>& call) {
    try {
      call();
    } catch (...) {
      return problem::problem_of(std::current_exception());
    }
    return {};
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
    const auto mesh = store.add_mesh(std::string(1000, 'm'), describe).first.id;
    store.add_mesh(std::string(1000, 'm'), describe);
    EXPECT_EQ(store.usage().meshes, 1000);
    std::ofstream(folder_ / "meshes" / (mesh + ".ply")) << "damaged";
    store.add_mesh(std::string(1000, 'm'), describe);
    add_ended(store, "kept", 5000);
    add_ended(store, "removed", 5000);
    store.remove_job("removed");
    for (const std::size_t bytes : {300, 300'000}) {
      const auto job = new_job("waits" + std::to_string(bytes));
      store.add_job(job, store.keep_request(job, {"POST", "/x", {}, {}, {}}, std::string(bytes, 'r')));
      store.keep_request(new_job("dropped"), {"POST", "/x", {}, {}, {}}, std::string(bytes, 'r'));
      store.drop_request("dropped");
    }
    store.add_mesh("gone", describe);
    store.remove_mesh(sha256("gone"));
    EXPECT_THROW(store.add_mesh("cannot be described",
                                [](const auto&, auto) -> std::string { throw Error("mesh.malformed", "x"); }),
                 Error);
    EXPECT_GT(store.usage().results, 5000);
    EXPECT_GT(store.usage().requests, 300'000);
    EXPECT_LT(store.usage().requests, 302'000);
    expect_exact(store, "used");
  }
  std::ofstream(folder_ / "meshes" / "unknown") << "into quarantine";
  LocalStore store(folder_, recovery());
  EXPECT_EQ(store.usage().quarantine, 15);
  expect_exact(store, "opened again");
  fs::remove_all(folder_ / "quarantine");
  store.remove_expired_jobs(0, 100);
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
  EXPECT_FALSE(store.job("j0"));
  EXPECT_FALSE(store.job("j1"));
  EXPECT_TRUE(store.job("j4"));
  EXPECT_EQ(store.job_result("j5").body.size(), static_cast<std::size_t>(result));
  store.add_job(new_job("unfinished"));
  store.add_mesh(std::string(4 * result, 'm'), describe);
  EXPECT_FALSE(store.job("j5")) << "a mesh is worth more than results";
  EXPECT_TRUE(store.job("unfinished"));
  EXPECT_LE(store.usage().total(), limit);
}

TEST_F(QuotaTest, RefusesWhatHasNoRoomAndNamesNumberLimitAndSetting) {
  constexpr std::int64_t limit = 4 << 20;
  LocalStore store(folder_, recovery(), {limit, 0});
  add_ended(store, "j", 1 << 20);
  const auto refused = problem_of([&] { store.add_mesh(std::string(limit, 'm'), describe); });
  EXPECT_EQ(refused.code, "store.quota");
  ASSERT_TRUE(refused.limit);
  EXPECT_EQ(refused.limit->limit, limit);
  EXPECT_GT(refused.limit->value, limit);
  EXPECT_EQ(refused.limit->setting, "--max-store");
  EXPECT_NE(refused.detail.find("mesh of " + std::to_string(limit) + " bytes"), std::string::npos) << refused.detail;
  EXPECT_TRUE(store.job("j")) << "nothing goes in vain";
  auto job = new_job("large");
  store.add_job(job);
  job.state = JobState::successful;
  const Result large{"text/plain", {}, std::string(limit, 'x')};
  EXPECT_EQ(problem_of([&] { store.finish_job(job, &large); }).code, "store.quota");
  EXPECT_EQ(problem_of([&] {
              store.keep_request(job, {"POST", "/x", {}, {}, {}}, std::string(limit, 'r'));
            }).code,
            "store.quota");
  EXPECT_LT(store.usage().total(), limit) << "what was refused takes nothing";
}

TEST_F(QuotaTest, LimitsTheBytesOfMeshes) {
  LocalStore store(folder_, recovery(), {0, 1500});
  store.add_mesh(std::string(1000, 'a'), describe);
  const auto refused = problem_of([&] { store.add_mesh(std::string(501, 'b'), describe); });
  EXPECT_EQ(refused.code, "store.quota");
  EXPECT_EQ(refused.limit->setting, "--max-mesh-bytes");
  EXPECT_EQ(refused.limit->value, 1501);
  store.add_mesh(std::string(500, 'b'), describe);
  store.remove_mesh(sha256(std::string(1000, 'a')));
  store.add_mesh(std::string(1000, 'c'), describe);
  EXPECT_EQ(store.usage().meshes, 1500);
}

TEST_F(QuotaTest, RemovesMeshesThatNobodyUses) {
  {
    LocalStore store(folder_);
    for (const char* ply : {"unused", "used", "worked on"}) store.add_mesh(ply, describe);
    auto job = new_job("j");
    job.mesh = sha256("worked on");
    store.add_job(job);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  const auto later = now_milliseconds();
  {
    LocalStore store(folder_);
    store.use_mesh(sha256("used"));
  }
  LocalStore store(folder_);
  EXPECT_TRUE(store.remove_unused_meshes(0).empty());
  EXPECT_EQ(store.remove_unused_meshes(later), std::vector{sha256("unused")});
  EXPECT_EQ(store.meshes(10, "").size(), 2U);
  EXPECT_EQ(store.usage().meshes, 13);
  store.remove_job("j");
  EXPECT_EQ(store.remove_unused_meshes(later), std::vector{sha256("worked on")});
}

}  // namespace
}  // namespace supple::store
