#include <sys/wait.h>

#include <csignal>

#include "database.h"
#include "store_fixture.h"

namespace supple::store {
namespace {

TEST_F(StoreTest, AMeshThatSeveralOwnGoesWithItsLastOwner) {
  Store store(folder_);
  const auto [mesh, is_new] = store.add_mesh("ply", describe, "a");
  EXPECT_TRUE(is_new);
  EXPECT_FALSE(store.add_mesh("ply", describe, "a").second);
  EXPECT_TRUE(store.is_last_owner_of_mesh(mesh.id, "a"));
  EXPECT_FALSE(store.owns_mesh(mesh.id, "b"));
  EXPECT_FALSE(store.remove_mesh(mesh.id, "b"));
  EXPECT_TRUE(store.add_mesh("ply", describe, "b").second) << "new to its second owner";
  EXPECT_FALSE(store.is_last_owner_of_mesh(mesh.id, "a"));
  EXPECT_TRUE(store.remove_mesh(mesh.id, "a"));
  EXPECT_FALSE(store.remove_mesh(mesh.id, "a"));
  EXPECT_TRUE(store.mesh(mesh.id));
  EXPECT_TRUE(store.remove_mesh(mesh.id, "b"));
  EXPECT_FALSE(store.mesh(mesh.id));
}

TEST_F(StoreTest, OwnersOutliveARestartAndGoWithWhatTheyOwn) {
  std::string id;
  {
    Store store(folder_);
    id = store.add_mesh("ply", describe, "a").first.id;
    store.add_job(new_job("j", "a"));
  }
  Store store(folder_);
  EXPECT_TRUE(store.owns_mesh(id, "a"));
  EXPECT_TRUE(store.owns_job("j", "a"));
  EXPECT_FALSE(store.owns_job("j", "b"));
  EXPECT_TRUE(store.remove_mesh(id));
  EXPECT_TRUE(store.remove_job("j"));
  store.add_mesh("ply", describe);
  store.add_job(new_job("j"));
  EXPECT_FALSE(store.owns_mesh(id, "a"));
  EXPECT_FALSE(store.owns_job("j", "a"));
}

TEST_F(StoreTest, NothingIsStoredWhoseOwnerIsNot) {
  Store store(folder_);
  // What a kill between two transactions would leave shows where the second one fails.
  Database(folder_ / "supple.sqlite")
      .execute("CREATE TRIGGER fault BEFORE INSERT ON owners BEGIN SELECT RAISE(ABORT, 'no owners today'); END");
  EXPECT_EQ(code_of([&] { store.add_job(new_job("j", "a")); }), "store.unavailable");
  EXPECT_FALSE(store.job("j"));
  EXPECT_EQ(code_of([&] { store.add_mesh("ply", describe, "a"); }), "store.unavailable");
  EXPECT_TRUE(store.meshes(10, "").empty());
  EXPECT_TRUE(fs::is_empty(folder_ / "meshes"));
  EXPECT_EQ(store.usage().meshes, 0);
  store.add_job(new_job("of nobody"));
  EXPECT_TRUE(store.add_mesh("ply", describe).second);
}

TEST_F(StoreTest, AJobHasItsOwnerFromTheMomentItCanBeSeen) {
  const pid_t child = fork();
  if (child == 0) {
    Store store(folder_);
    for (int i = 0;; ++i) store.add_job(new_job("j" + std::to_string(i), "a"));
  }
  constexpr std::size_t enough = 50;
  const auto seen = [&] {
    // Another process sees what was committed.
    try {
      const Database database(folder_ / "supple.sqlite");
      Statement row(database, "SELECT COUNT(*) FROM jobs WHERE id NOT IN (SELECT id FROM owners WHERE kind = 'job')");
      row.step();
      EXPECT_EQ(row.integer(0), 0);
      Statement all(database, "SELECT COUNT(*) FROM jobs");
      all.step();
      return static_cast<std::size_t>(all.integer(0));
    } catch (const Error&) {
      return std::size_t{0};  // its tables are not there yet
    }
  };
  while (seen() < enough) usleep(100);
  ::kill(child, SIGKILL);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  const Store store(folder_);
  const auto all = store.jobs({}, 100'000, "");
  EXPECT_EQ(store.jobs({}, 100'000, "", "a").size(), all.size());
  EXPECT_GE(all.size(), enough);
  EXPECT_EQ(all[0].owner, "a");
}

TEST_F(StoreTest, AJobHasItsOwnerAgainWhenTheDatabaseIsLost) {
  {
    Store store(folder_);
    auto waits = new_job("waits", "a");
    store.add_job(waits, store.keep_request(waits, {"POST", "/x", {}, {}, {}}, std::string(300'000, 'x')));
    auto ended = new_job("ended", "b");
    store.add_job(ended);
    ended.state = JobState::successful;
    ended.finished = now_milliseconds();
    const Result result{"text/plain", {}, "42"};
    store.finish_job(ended, &result);
  }
  fs::remove(folder_ / "supple.sqlite");
  const Store store(folder_, recovery());
  EXPECT_TRUE(store.owns_job("waits", "a"));
  EXPECT_TRUE(store.owns_job("ended", "b"));
  EXPECT_FALSE(store.owns_job("ended", "a"));
}

TEST_F(StoreTest, ListsWhatOneOwnerHasPageByPage) {
  Store store(folder_);
  std::vector<std::string> of_a;
  for (int i = 0; i < 5; ++i) {
    of_a.insert(of_a.begin(), store.add_mesh("a" + std::to_string(i), describe, "a").first.id);
    store.add_mesh("b" + std::to_string(i), describe, "b");
    store.add_mesh("nobody" + std::to_string(i), describe);
    for (const char* owner : {"a", "b"}) {
      const auto job = std::string(owner) + std::to_string(i);
      store.add_job(new_job(job, owner));
    }
  }
  const auto first = store.meshes(3, "", "a");
  ASSERT_EQ(first.size(), 3U);
  const auto rest = store.meshes(3, first.back().id, "a");
  ASSERT_EQ(rest.size(), 2U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ((i < 3 ? first[i] : rest[i - 3]).id, of_a[i]);
  EXPECT_EQ(store.meshes(100, "").size(), 15U);
  const auto jobs = store.jobs({}, 3, "a3", "a");
  ASSERT_EQ(jobs.size(), 3U);
  EXPECT_EQ(jobs[0].id, "a2");
  EXPECT_TRUE(store.jobs({JobState::failed}, 100, "", "a").empty());
  EXPECT_EQ(store.jobs({}, 100, "").size(), 10U);
}

}  // namespace
}  // namespace supple::store
