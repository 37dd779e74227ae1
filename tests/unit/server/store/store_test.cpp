#include "supple/store/store.h"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <set>

#include "supple/base/error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test.
class StoreTest : public testing::Test {
 protected:
  StoreTest() {
    std::string pattern = (fs::temp_directory_path() / "supple_store_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~StoreTest() override { fs::remove_all(folder_); }

  static std::string describe(const std::string& id, std::int64_t) { return "{\"id\":\"" + id + "\"}"; }

  static JobRecord new_job(const std::string& id) {
    JobRecord job;
    job.id = id;
    job.kind = "geodesics";
    job.mesh = "m";
    job.created = now_milliseconds();
    job.deadline = 1.5;
    return job;
  }

  static std::string code_of(const std::function<void()>& call) {
    try {
      call();
    } catch (const Error& error) {
      return error.code();
    }
    return "nothing was thrown";
  }

  /// Knows only "no mesh" as no mesh.
  Store::Recovery recovery() {
    return {[](const std::string& ply, const std::string& id, std::int64_t created) {
              if (ply == "no mesh") throw Error("mesh.malformed", "This is no mesh.");
              return describe(id, created);
            },
            [this](const std::string& text) { warnings_.push_back(text); }};
  }
  /// The contents of what is in quarantine.
  std::multiset<std::string> quarantined() const {
    std::multiset<std::string> contents;
    for (const auto& entry : fs::directory_iterator(folder_ / "quarantine")) {
      std::ifstream file(entry.path(), std::ios::binary);
      contents.emplace(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
    return contents;
  }

  fs::path folder_;
  std::vector<std::string> warnings_;
};

TEST_F(StoreTest, NamesAMeshByTheHashOfItsContent) {
  Store store(folder_);
  const auto [record, is_new] = store.add_mesh("abc", describe);
  EXPECT_TRUE(is_new);
  EXPECT_EQ(record.id, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(store.mesh_content(record.id), "abc");
}

TEST_F(StoreTest, KeepsAMeshThatIsAddedTwiceOnce) {
  Store store(folder_);
  const auto first = store.add_mesh("abc", describe).first;
  const auto [second, is_new] = store.add_mesh("abc", describe);
  EXPECT_FALSE(is_new);
  EXPECT_EQ(second.created, first.created);
  EXPECT_EQ(store.meshes(10, "").size(), 1U);
}

TEST_F(StoreTest, ListsInPagesTheNewestFirst) {
  Store store(folder_);
  std::vector<std::string> ids;
  for (const char* content : {"a", "b", "c"}) ids.push_back(store.add_mesh(content, describe).first.id);
  const auto page = store.meshes(2, "");
  ASSERT_EQ(page.size(), 2U);
  EXPECT_EQ(page[0].id, ids[2]);
  EXPECT_EQ(page[1].id, ids[1]);
  const auto rest = store.meshes(2, page[1].id);
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_EQ(rest[0].id, ids[0]);
}

TEST_F(StoreTest, FindsAChangedFileByItsHash) {
  Store store(folder_);
  const auto id = store.add_mesh("abc", describe).first.id;
  std::ofstream(folder_ / "meshes" / (id + ".ply")) << "abd";
  EXPECT_EQ(code_of([&] { store.mesh_content(id); }), "store.corrupted");
  store.add_mesh("abc", describe);
  EXPECT_EQ(store.mesh_content(id), "abc") << "uploading again repairs it";
  fs::remove(folder_ / "meshes" / (id + ".ply"));
  EXPECT_EQ(code_of([&] { store.mesh_content(id); }), "store.corrupted");
}

TEST_F(StoreTest, KeepsMeshesJobsAndResultsOverARestart) {
  std::string mesh;
  {
    Store store(folder_);
    mesh = store.add_mesh("abc", describe).first.id;
    auto job = new_job("j1");
    store.add_job(job);
    job.state = JobState::successful;
    job.finished = job.created + 5;
    const Result result{"application/octet-stream", {{"A", "1"}, {"B", "x: y"}}, std::string("\0\n\xFF", 3)};
    store.finish_job(job, &result);
  }
  Store store(folder_);
  EXPECT_EQ(store.mesh_content(mesh), "abc");
  const auto job = store.job("j1");
  ASSERT_TRUE(job);
  EXPECT_EQ(job->state, JobState::successful);
  EXPECT_EQ(job->deadline, 1.5);
  const auto result = store.job_result("j1");
  EXPECT_EQ(result.body, std::string("\0\n\xFF", 3));
  EXPECT_EQ(result.headers, (std::vector<std::pair<std::string, std::string>>{{"A", "1"}, {"B", "x: y"}}));
}

TEST_F(StoreTest, LosesNothingThatWasFinishedWhenTheProcessIsKilled) {
  const pid_t child = fork();
  if (child == 0) {
    Store store(folder_);
    store.add_mesh("abc", describe);
    auto job = new_job("done");
    store.add_job(job);
    store.add_job(new_job("open"));
    job.state = JobState::successful;
    const Result result{"text/plain", {}, "result"};
    store.finish_job(job, &result);
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  Store store(folder_);
  EXPECT_EQ(store.meshes(10, "").size(), 1U);
  EXPECT_EQ(store.job_result("done").body, "result");
  ASSERT_EQ(store.unfinished_jobs().size(), 1U);
  EXPECT_EQ(store.unfinished_jobs()[0].id, "open");
}

TEST_F(StoreTest, RemovesOnlyWhatWasNeverAcknowledged) {
  {
    Store store(folder_);
    store.add_job(new_job("open"));
  }
  for (const char* name : {"meshes/ab.ply.0.part", "results/x.result.1.part", "results/open.result"})
    std::ofstream(folder_ / name) << "x";
  const Store store(folder_, recovery());
  EXPECT_TRUE(fs::is_empty(folder_ / "meshes"));
  EXPECT_TRUE(fs::is_empty(folder_ / "results"));
  EXPECT_FALSE(fs::exists(folder_ / "quarantine"));
}

TEST_F(StoreTest, MovesUnknownFilesIntoQuarantine) {
  { Store store(folder_); }
  const auto wrong_hash = std::string(64, '0') + ".ply";
  const auto no_mesh = sha256("no mesh") + ".ply";
  std::ofstream(folder_ / "meshes" / wrong_hash) << "abc";
  std::ofstream(folder_ / "meshes" / no_mesh) << "no mesh";
  std::ofstream(folder_ / "meshes" / "notes.txt") << "mine";
  std::ofstream(folder_ / "results" / "x.result") << "first";
  { const Store store(folder_, recovery()); }
  std::ofstream(folder_ / "results" / "x.result") << "second";
  const Store store(folder_, recovery());
  EXPECT_TRUE(store.meshes(10, "").empty());
  EXPECT_TRUE(fs::is_empty(folder_ / "meshes"));
  EXPECT_TRUE(fs::is_empty(folder_ / "results"));
  const auto kept = quarantined();
  EXPECT_EQ(kept.size(), 5U);
  for (const auto& text : {"abc", "no mesh", "mine", "first", "second"}) EXPECT_EQ(kept.count(text), 1U) << text;
  EXPECT_GE(warnings_.size(), 5U);
}

TEST_F(StoreTest, IndexesMeshesAgainWhoseDatabaseIsLost) {
  MeshRecord before;
  {
    Store store(folder_);
    before = store.add_mesh("abc", describe).first;
  }
  fs::remove(folder_ / "supple.sqlite");
  const Store store(folder_, recovery());
  const auto after = store.mesh(before.id);
  ASSERT_TRUE(after);
  EXPECT_EQ(after->description, before.description);
  EXPECT_NEAR(static_cast<double>(after->created), static_cast<double>(before.created), 5000);
  EXPECT_EQ(store.mesh_content(before.id), "abc");
}

TEST_F(StoreTest, SetsADamagedDatabaseAsideAndLosesNoFile) {
  const auto database = folder_ / "supple.sqlite";
  const auto overwrite = [&](std::streamoff begin, std::size_t count) {
    std::fstream file(database, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(begin) << std::string(count, '\xA5');
  };
  const std::vector<std::pair<const char*, std::function<void()>>> damages{
      {"its head", [&] { overwrite(0, 100); }},
      {"its pages", [&] { overwrite(4096, 8000); }},
      {"its end", [&] { fs::resize_file(database, 4096 + 100); }},
  };
  for (const auto& [name, damage] : damages) {
    fs::remove_all(folder_);
    warnings_.clear();
    std::string mesh;
    {
      Store store(folder_);
      mesh = store.add_mesh("abc", describe).first.id;
      auto job = new_job("j");
      store.add_job(job);
      job.state = JobState::successful;
      const Result result{"text/plain", {}, "42"};
      store.finish_job(job, &result);
    }
    damage();
    Store store(folder_, recovery());
    EXPECT_EQ(store.mesh_content(mesh), "abc") << name;
    EXPECT_EQ(store.meshes(10, "").size(), 1U) << name;
    EXPECT_FALSE(store.job("j")) << name;
    const auto kept = quarantined();
    EXPECT_EQ(kept.count("42"), 1U) << name;
    EXPECT_EQ(kept.size(), 2U) << name << ": the database and the result";
    EXPECT_NE(warnings_.at(0).find("damaged"), std::string::npos) << warnings_.at(0);
    EXPECT_EQ(store.add_mesh("more", describe).second, true) << name << ": it is a store again";
  }
}

TEST_F(StoreTest, RefusesAFolderThatIsInUse) {
  Store store(folder_);
  EXPECT_EQ(code_of([&] { Store second(folder_); }), "store.unavailable");
}

TEST_F(StoreTest, SaysThatAFolderCannotBeMade) {
  std::ofstream(folder_ / "file") << "x";
  EXPECT_EQ(code_of([&] { Store store(folder_ / "file" / "data"); }), "store.unavailable");
}

TEST_F(StoreTest, SaysThatTheDiskIsFullAndTakesWritesAgainOnceThereIsSpace) {
  if (::mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=1m") != 0) GTEST_SKIP() << "mounting takes root";
  {
    Store store(folder_);
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
    EXPECT_EQ(store.job_result("j").body, "x");
  }
  EXPECT_EQ(::umount(folder_.c_str()), 0);
}

TEST_F(StoreTest, LetsOnlyItsUserReadItsFiles) {
  Store store(folder_);
  const auto mesh = store.add_mesh("abc", describe).first.id;
  for (const auto& path : {folder_ / "supple.sqlite", folder_ / "lock", folder_ / "meshes" / (mesh + ".ply")})
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write) << path;
}

TEST_F(StoreTest, LetsOnlyItsUserEnterItsFolder) {
  const auto data = folder_ / "new" / "data";
  {
    const Store store(data, recovery());
    EXPECT_EQ(fs::status(data).permissions(), fs::perms::owner_all);
    EXPECT_TRUE(warnings_.empty()) << "nothing is said of a folder that the store made";
  }
  fs::permissions(data, fs::perms::owner_all | fs::perms::group_all | fs::perms::others_read);
  {
    const Store store(data, recovery());
    EXPECT_EQ(fs::status(data).permissions(), fs::perms::owner_all);
    ASSERT_EQ(warnings_.size(), 1U);
    EXPECT_NE(warnings_[0].find("0700"), std::string::npos);
  }
  const Store store(data, recovery());
  EXPECT_EQ(warnings_.size(), 1U) << "said once";
}

TEST_F(StoreTest, RemovesExpiredJobsAndTheOldestBeyondTheLimit) {
  Store store(folder_);
  for (int i = 0; i < 5; ++i) {
    auto job = new_job("j" + std::to_string(i));
    store.add_job(job);
    if (i == 4) continue;
    job.state = JobState::failed;
    job.finished = 1000;
    job.expires = i == 3 ? 1500 : 5000;
    store.finish_job(job, nullptr);
  }
  EXPECT_EQ(store.remove_expired_jobs(2000, 3), 2U) << "j3 has expired; j0 is the oldest of four";
  EXPECT_FALSE(store.job("j0"));
  EXPECT_TRUE(store.job("j1"));
  EXPECT_FALSE(store.job("j3"));
  EXPECT_TRUE(store.job("j4")) << "an unfinished job is never removed";
}

TEST_F(StoreTest, KeepsTheResultsOfExpiredJobsWhereTheRowsCannotBeRemoved) {
  if (::mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=1m") != 0) GTEST_SKIP() << "mounting takes root";
  {
    Store store(folder_);
    auto job = new_job("j");
    store.add_job(job);
    job.state = JobState::successful;
    job.finished = 1000;
    job.expires = 1500;
    const Result result{"text/plain", {}, "42"};
    store.finish_job(job, &result);
    std::ofstream ballast(folder_ / "ballast", std::ios::binary);
    while (ballast.put('x').flush()) {
    }
    ballast.close();
    EXPECT_EQ(code_of([&] { store.remove_expired_jobs(2000, 10); }), "store.full");
    EXPECT_EQ(store.job_result("j").body, "42") << "the row is still there, and so is its file";
    fs::remove(folder_ / "ballast");
    EXPECT_EQ(store.remove_expired_jobs(2000, 10), 1U);
    EXPECT_TRUE(fs::is_empty(folder_ / "results"));
  }
  EXPECT_EQ(::umount(folder_.c_str()), 0);
}

TEST_F(StoreTest, KeepsNoResultOfAJobThatWasRemovedMeanwhile) {
  Store store(folder_);
  auto job = new_job("j");
  store.add_job(job);
  EXPECT_TRUE(store.remove_job("j"));
  EXPECT_FALSE(store.remove_job("j"));
  const Result result{"text/plain", {}, "late"};
  store.finish_job(job, &result);
  EXPECT_TRUE(fs::is_empty(folder_ / "results"));
}

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
    store.add_job(new_job("j"));
    store.own_job("j", "a");
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

TEST_F(StoreTest, ListsWhatOneOwnerHasPageByPage) {
  Store store(folder_);
  std::vector<std::string> of_a;
  for (int i = 0; i < 5; ++i) {
    of_a.insert(of_a.begin(), store.add_mesh("a" + std::to_string(i), describe, "a").first.id);
    store.add_mesh("b" + std::to_string(i), describe, "b");
    store.add_mesh("nobody" + std::to_string(i), describe);
    for (const char* owner : {"a", "b"}) {
      const auto job = std::string(owner) + std::to_string(i);
      store.add_job(new_job(job));
      store.own_job(job, owner);
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
  EXPECT_TRUE(store.jobs(JobState::failed, 100, "", "a").empty());
  EXPECT_EQ(store.jobs({}, 100, "").size(), 10U);
}

}  // namespace
}  // namespace supple::store
