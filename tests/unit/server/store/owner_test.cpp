#include <sys/wait.h>

#include <csignal>

#include "database.h"
#include "store_fixture.h"
#include "supple/problem/problem.h"
#include "unit/server/thrown_problem.h"

namespace supple::store {
namespace {

TEST_F(StoreTest, AMeshThatSeveralOwnGoesWithItsLastOwner) {
  LocalStore store(folder_);
  const auto [mesh, is_new] = store.meshes().add_mesh("ply", describe, "a");
  EXPECT_TRUE(is_new);
  EXPECT_FALSE(store.meshes().add_mesh("ply", describe, "a").second);
  EXPECT_TRUE(store.meshes().is_last_owner_of_mesh(mesh.id, "a"));
  EXPECT_FALSE(store.meshes().owns_mesh(mesh.id, "b"));
  EXPECT_FALSE(store.meshes().remove_mesh(mesh.id, "b"));
  EXPECT_TRUE(store.meshes().add_mesh("ply", describe, "b").second) << "new to its second owner";
  EXPECT_FALSE(store.meshes().is_last_owner_of_mesh(mesh.id, "a"));
  EXPECT_TRUE(store.meshes().remove_mesh(mesh.id, "a"));
  EXPECT_FALSE(store.meshes().remove_mesh(mesh.id, "a"));
  EXPECT_TRUE(store.meshes().mesh(mesh.id));
  EXPECT_TRUE(store.meshes().remove_mesh(mesh.id, "b"));
  EXPECT_FALSE(store.meshes().mesh(mesh.id));
}

TEST_F(StoreTest, OwnersOutliveARestartAndGoWithWhatTheyOwn) {
  std::string id;
  {
    LocalStore store(folder_);
    id = store.meshes().add_mesh("ply", describe, "a").first.id;
    store.jobs().add_job(new_job("j", "a"));
  }
  LocalStore store(folder_);
  EXPECT_TRUE(store.meshes().owns_mesh(id, "a"));
  EXPECT_TRUE(store.jobs().owns_job("j", "a"));
  EXPECT_FALSE(store.jobs().owns_job("j", "b"));
  EXPECT_TRUE(store.meshes().remove_mesh(id));
  EXPECT_TRUE(store.jobs().remove_job("j"));
  store.meshes().add_mesh("ply", describe);
  store.jobs().add_job(new_job("j"));
  EXPECT_FALSE(store.meshes().owns_mesh(id, "a"));
  EXPECT_FALSE(store.jobs().owns_job("j", "a"));
}

TEST_F(StoreTest, NothingIsStoredWhoseOwnerIsNot) {
  LocalStore store(folder_);
  // Where the second of two statements fails, the test shows what a kill between two transactions would leave.
  Database(folder_ / "supple.sqlite")
      .execute("CREATE TRIGGER fault BEFORE INSERT ON owners BEGIN SELECT RAISE(ABORT, 'no owners today'); END");
  EXPECT_EQ(code_of([&] { store.jobs().add_job(new_job("j", "a")); }), "store.unavailable");
  EXPECT_FALSE(store.jobs().job("j"));
  EXPECT_EQ(code_of([&] { store.meshes().add_mesh("ply", describe, "a"); }), "store.unavailable");
  EXPECT_TRUE(store.meshes().meshes(10, "").empty());
  EXPECT_TRUE(fs::is_empty(folder_ / "meshes"));
  EXPECT_EQ(store.usage().meshes, 0);
  store.jobs().add_job(new_job("of nobody"));
  EXPECT_TRUE(store.meshes().add_mesh("ply", describe).second);
}

TEST_F(StoreTest, AJobHasItsOwnerFromTheMomentItCanBeSeen) {
  const pid_t child = fork();
  if (child == 0) {
    LocalStore store(folder_);
    for (int i = 0;; ++i) store.jobs().add_job(new_job("j" + std::to_string(i), "a"));
  }
  constexpr std::size_t enough = 50;
  const auto seen = [&] {
    // This process sees what the other one has committed.
    try {
      const Database database(folder_ / "supple.sqlite");
      Statement row(database, "SELECT COUNT(*) FROM jobs WHERE id NOT IN (SELECT id FROM owners WHERE kind = 'job')");
      row.step();
      EXPECT_EQ(row.integer(0), 0);
      Statement all(database, "SELECT COUNT(*) FROM jobs");
      all.step();
      return static_cast<std::size_t>(all.integer(0));
    } catch (const Error&) {
      return std::size_t{0};  // the other process has not made its tables yet
    }
  };
  while (seen() < enough) usleep(100);
  ::kill(child, SIGKILL);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  const LocalStore store(folder_);
  const auto all = store.jobs().jobs({}, 100'000, "");
  EXPECT_EQ(store.jobs().jobs({}, 100'000, "", "a").size(), all.size());
  EXPECT_GE(all.size(), enough);
  EXPECT_EQ(all[0].owner, "a");
}

TEST_F(StoreTest, AJobHasItsOwnerAgainWhenTheDatabaseIsLost) {
  {
    LocalStore store(folder_);
    auto waits = new_job("waits", "a");
    store.jobs().add_job(waits,
                         store.blobs().store_request(waits, {"POST", "/x", {}, {}, {}}, std::string(300'000, 'x')));
    auto ended = new_job("ended", "b");
    store.jobs().add_job(ended);
    ended.state = JobState::successful;
    ended.finished = now_milliseconds();
    const Result result{"text/plain", {}, "42"};
    store.jobs().finish_job(ended, &result);
  }
  fs::remove(folder_ / "supple.sqlite");
  const LocalStore store(folder_, recovery());
  EXPECT_TRUE(store.jobs().owns_job("waits", "a"));
  EXPECT_TRUE(store.jobs().owns_job("ended", "b"));
  EXPECT_FALSE(store.jobs().owns_job("ended", "a"));
}

/// Tests of stores in which the owner "small" may have 10,000 bytes, and all others have no limit.
class OwnerQuotaTest : public StoreTest {
 protected:
  static constexpr std::int64_t limit = 10'000;

  static Quota quota() {
    return {0, 0, [](const std::string& owner) { return owner == "small" ? limit : 0; }};
  }
  static void add_ended(Store& store, const std::string& id, const std::string& owner, std::size_t bytes) {
    auto job = new_job(id, owner);
    store.jobs().add_job(job);
    job.state = JobState::successful;
    job.finished = now_milliseconds();
    job.expires = job.finished + 1'000'000;
    const Result result{"text/plain", {}, std::string(bytes, 'x')};
    store.jobs().finish_job(job, &result);
  }
};

TEST_F(OwnerQuotaTest, AMeshThatIsTooMuchIsRefusedWithNumberLimitAndSetting) {
  LocalStore store(folder_, {}, quota());
  store.meshes().add_mesh(std::string(6000, 'a'), describe, "small");
  const auto refused = thrown_problem([&] { store.meshes().add_mesh(std::string(4001, 'b'), describe, "small"); });
  EXPECT_EQ(refused.code, "store.key_quota");
  ASSERT_TRUE(refused.limit);
  EXPECT_EQ(refused.limit->limit, limit);
  EXPECT_EQ(refused.limit->value, limit + 1);
  EXPECT_EQ(refused.limit->setting, "--max-stored");
  EXPECT_NE(refused.detail.find("the key small"), std::string::npos) << refused.detail;
  EXPECT_EQ(store.usage().meshes, 6000) << "what was refused takes nothing";
  store.meshes().add_mesh(std::string(4001, 'b'), describe, "large");
  store.meshes().add_mesh(std::string(4001, 'c'), describe);
  EXPECT_EQ(thrown_problem([&] { store.meshes().add_mesh(std::string(4001, 'b'), describe, "small"); }).code,
            "store.key_quota")
      << "of one that another has stored";
  EXPECT_FALSE(store.meshes().add_mesh(std::string(6000, 'a'), describe, "small").second) << "it has this one already";
  store.meshes().remove_mesh(sha256(std::string(6000, 'a')), "small");
  EXPECT_TRUE(store.meshes().add_mesh(std::string(4001, 'b'), describe, "small").second);
}

TEST_F(OwnerQuotaTest, ItsOldestResultsMakeRoomAndNobodyElses) {
  LocalStore store(folder_, {}, quota());
  add_ended(store, "of another", "large", 4000);
  for (int i = 0; i < 4; ++i) add_ended(store, "j" + std::to_string(i), "small", 4000);
  EXPECT_TRUE(store.jobs().job("of another"));
  EXPECT_FALSE(store.jobs().job("j0"));
  EXPECT_FALSE(store.jobs().job("j1"));
  EXPECT_EQ(store.blobs().job_result("j2").body.size(), 4000U);
  EXPECT_EQ(store.blobs().job_result("j3").body.size(), 4000U);
  store.meshes().add_mesh(std::string(6000, 'm'), describe, "small");
  EXPECT_FALSE(store.jobs().job("j3")) << "one result does not fit beside its mesh and the other";
  EXPECT_EQ(thrown_problem([&] { add_ended(store, "too large", "small", 4000); }).code, "store.key_quota");
  EXPECT_EQ(store.jobs().job("too large")->state, JobState::accepted) << "whoever ran it says that it has failed";
  EXPECT_FALSE(fs::exists(folder_ / "results" / "too large.result"));
  add_ended(store, "small enough", "small", 3000);
}

TEST_F(OwnerQuotaTest, CountsRequestsUntilTheirJobsEnd) {
  LocalStore store(folder_, {}, quota());
  const auto add = [&](const std::string& id, std::size_t bytes) {
    const auto job = new_job(id, "small");
    store.jobs().add_job(job, store.blobs().store_request(job, {"POST", "/x", {}, {}, {}}, std::string(bytes, 'r')));
  };
  add("waits", 7000);
  const auto refused = thrown_problem([&] { add("too many", 3000); });
  EXPECT_EQ(refused.code, "store.key_quota");
  EXPECT_NE(refused.detail.find("request of"), std::string::npos) << refused.detail;
  EXPECT_FALSE(store.blobs().has_request("too many"));
  EXPECT_FALSE(store.jobs().job("too many"));
  auto job = *store.jobs().job("waits");
  job.state = JobState::successful;
  job.finished = now_milliseconds();
  const Result result{"text/plain", {}, std::string(9000, 'x')};
  store.jobs().finish_job(job, &result);
  EXPECT_EQ(store.blobs().job_result("waits").body.size(), 9000U) << "its own request makes room for its result";
  EXPECT_EQ(thrown_problem([&] { add("far too large", 300'000); }).code, "store.key_quota");
  EXPECT_FALSE(fs::exists(folder_ / "requests" / "far too large.request"));
}

TEST_F(OwnerQuotaTest, CountsTheSameAfterARestartAndOfAnEarlierVersionAndALostDatabase) {
  {
    LocalStore store(folder_, {}, quota());
    store.meshes().add_mesh(std::string(3000, 'a'), describe, "small");
    add_ended(store, "j", "small", 3000);
    const auto job = new_job("waits", "small");
    store.jobs().add_job(job, store.blobs().store_request(job, {"POST", "/x", {}, {}, {}}, std::string(100, 'r')));
  }
  const auto held = [&] {
    const Database database(folder_ / "supple.sqlite");
    Statement row(database, "SELECT (SELECT SUM(bytes) FROM meshes), (SELECT SUM(bytes) FROM jobs)");
    row.step();
    return std::pair(row.integer(0), row.integer(1));
  };
  const auto before = held();
  EXPECT_EQ(before.first, 3000);
  EXPECT_GT(before.second, 3100);
  EXPECT_LT(before.second, 4500);
  Database(folder_ / "supple.sqlite")
      .execute("UPDATE meshes SET bytes = -1; UPDATE jobs SET bytes = -1 WHERE id = 'j'");
  { LocalStore store(folder_, recovery(), quota()); }
  EXPECT_EQ(held(), before);
  fs::remove(folder_ / "supple.sqlite");
  LocalStore store(folder_, recovery(), quota());
  EXPECT_EQ(held().first, before.first);
  store.meshes().add_mesh(std::string(3000, 'a'), describe, "small");
  const auto refused = thrown_problem([&] { store.meshes().add_mesh(std::string(8000, 'b'), describe, "small"); });
  EXPECT_EQ(refused.code, "store.key_quota");
  EXPECT_GT(refused.limit->value, 14'000) << "its result counts again";
}

TEST_F(StoreTest, ListsWhatOneOwnerHasPageByPage) {
  LocalStore store(folder_);
  std::vector<std::string> of_a;
  for (int i = 0; i < 5; ++i) {
    of_a.insert(of_a.begin(), store.meshes().add_mesh("a" + std::to_string(i), describe, "a").first.id);
    store.meshes().add_mesh("b" + std::to_string(i), describe, "b");
    store.meshes().add_mesh("nobody" + std::to_string(i), describe);
    for (const char* owner : {"a", "b"}) {
      const auto job = std::string(owner) + std::to_string(i);
      store.jobs().add_job(new_job(job, owner));
    }
  }
  const auto first = store.meshes().meshes(3, "", "a");
  ASSERT_EQ(first.size(), 3U);
  const auto rest = store.meshes().meshes(3, first.back().id, "a");
  ASSERT_EQ(rest.size(), 2U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ((i < 3 ? first[i] : rest[i - 3]).id, of_a[i]);
  EXPECT_EQ(store.meshes().meshes(100, "").size(), 15U);
  const auto jobs = store.jobs().jobs({}, 3, "a3", "a");
  ASSERT_EQ(jobs.size(), 3U);
  EXPECT_EQ(jobs[0].id, "a2");
  EXPECT_TRUE(store.jobs().jobs({JobState::failed}, 100, "", "a").empty());
  EXPECT_EQ(store.jobs().jobs({}, 100, "").size(), 10U);
}

}  // namespace
}  // namespace supple::store
