#include "supple/store/store.h"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <thread>

#include "database.h"
#include "supple/base/error.h"
#include "supple/problem/problem.h"

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
    EXPECT_EQ(store.job_result("j").body, "42") << name;
    EXPECT_EQ(quarantined().size(), 1U) << name << ": the database";
    EXPECT_NE(warnings_.at(0).find("damaged"), std::string::npos) << warnings_.at(0);
    EXPECT_EQ(store.add_mesh("more", describe).second, true) << name << ": it is a store again";
  }
}

TEST_F(StoreTest, AnswersResultsOfALostDatabaseAgainInTheirOrder) {
  std::vector<JobRecord> before;
  const Result result{"application/octet-stream", {{"A", "1"}, {"B", "x: y"}}, std::string("\0\n\xFF", 3)};
  {
    Store store(folder_);
    for (int i = 0; i < 5; ++i) {
      auto job = new_job("j" + std::to_string(9 - i));
      job.created = 1000 + i;
      job.client = "127.0.0.1";
      job.session = "line\nend: \\";
      job.attempts = 1;
      store.add_job(job);
      job.state = JobState::successful;
      job.started = 2000;
      job.finished = 3000;
      job.expires = 4'000'000'000'000;
      store.finish_job(job, &result);
      before.push_back(job);
    }
  }
  fs::remove(folder_ / "supple.sqlite");
  const Store store(folder_, recovery());
  const auto after = store.jobs({}, 10, "");
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    const auto& expected = before[before.size() - 1 - i];
    EXPECT_EQ(after[i].id, expected.id);
    EXPECT_EQ(after[i].state, JobState::successful);
    EXPECT_EQ(after[i].session, expected.session);
    EXPECT_EQ(after[i].expires, expected.expires);
    const auto again = store.job_result(expected.id);
    EXPECT_EQ(again.body, result.body);
    EXPECT_EQ(again.content_type, result.content_type);
    EXPECT_EQ(again.headers, result.headers);
  }
}

TEST_F(StoreTest, PutsChangedResultsOfALostDatabaseIntoQuarantine) {
  {
    Store store(folder_);
    for (const char* id : {"head", "body", "name"}) {
      auto job = new_job(id);
      store.add_job(job);
      job.state = JobState::successful;
      const Result result{"text/plain", {}, "forty-two"};
      store.finish_job(job, &result);
    }
  }
  const auto change = [&](const char* id, std::string_view from, std::string_view to) {
    const auto path = folder_ / "results" / (std::string(id) + ".result");
    std::stringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    auto content = text.str();
    content.replace(content.find(from), from.size(), to);
    std::ofstream(path, std::ios::binary) << content;
  };
  change("head", "kind: geodesics", "kind: geodesicX");
  change("body", "forty-two", "forty-six");
  fs::rename(folder_ / "results" / "name.result", folder_ / "results" / "other.result");
  fs::remove(folder_ / "supple.sqlite");
  const Store store(folder_, recovery());
  EXPECT_TRUE(store.jobs({}, 10, "").empty());
  EXPECT_TRUE(fs::is_empty(folder_ / "results"));
  EXPECT_EQ(quarantined().size(), 3U);
}

TEST_F(StoreTest, ReadsAFolderOfTheVersionBefore) {
  {
    Store store(folder_);
    auto job = new_job("old");
    store.add_job(job);
    job.state = JobState::successful;
    const Result result{"text/plain", {{"A", "1"}}, "42"};
    store.finish_job(job, &result);
  }
  const auto change = [&](const char* statement) { Database(folder_ / "supple.sqlite").execute(statement); };
  for (const char* statement :
       {"ALTER TABLE jobs DROP COLUMN client", "ALTER TABLE jobs DROP COLUMN session",
        "ALTER TABLE jobs DROP COLUMN attempts", "ALTER TABLE meshes DROP COLUMN used", "PRAGMA user_version = 1"})
    change(statement);
  std::ofstream(folder_ / "results" / "old.result") << "42";  // the body alone
  {
    Store store(folder_, recovery());
    EXPECT_EQ(store.job_result("old").body, "42");
    store.add_job(new_job("new"));
    EXPECT_EQ(store.unfinished_jobs().size(), 1U);
    EXPECT_TRUE(warnings_.empty());
  }
  change("PRAGMA user_version = 3");
  EXPECT_EQ(code_of([&] { Store store(folder_, recovery()); }), "store.unavailable") << "of a later version";
}

/// Of requests that are kept in the database, and of ones that are too large for it.
class RequestTest : public StoreTest, public testing::WithParamInterface<std::size_t> {
 protected:
  const std::string body_ = "{\"body\": 1}" + std::string(1, '\0') + std::string(GetParam(), '\xFF');
};
INSTANTIATE_TEST_SUITE_P(Sizes, RequestTest, testing::Values(1000, 300'000));

TEST_P(RequestTest, IsKeptUntilItsJobHasEnded) {
  const JobRequest request{"POST", "/v1/geodesics", {{"a", "1"}, {"b:\n", "x"}}, "application/json", "text/csv"};
  {
    Store store(folder_);
    for (const char* id : {"first", "second", "ended", "removed"}) {
      const auto job = new_job(id);
      store.add_job(job, store.keep_request(job, request, body_));
    }
    store.keep_request(new_job("never added"), request, body_);
    auto job = *store.job("second");
    job.state = JobState::running;
    job.started = 5;
    job.attempts = 2;
    store.note_progress(job);
    job = *store.job("ended");
    job.state = JobState::failed;
    job.finished = 1000;
    store.finish_job(job, nullptr);
    store.note_progress(new_job("ended"));
    EXPECT_EQ(store.job("ended")->state, JobState::failed) << "it has finished";
    store.remove_job("removed");
    EXPECT_FALSE(store.has_request("ended"));
    EXPECT_FALSE(store.has_request("removed"));
  }
  const Store store(folder_, recovery());
  EXPECT_FALSE(store.has_request("never added"));
  const auto unfinished = store.unfinished_jobs();
  ASSERT_EQ(unfinished.size(), 2U);
  EXPECT_EQ(unfinished[0].id, "first");
  EXPECT_EQ(unfinished[1].id, "second");
  EXPECT_EQ(unfinished[1].state, JobState::running);
  EXPECT_EQ(unfinished[1].attempts, 2);
  const auto kept = store.job_request("first");
  EXPECT_EQ(kept.body, body_);
  EXPECT_EQ(kept.request.method, "POST");
  EXPECT_EQ(kept.request.path, "/v1/geodesics");
  EXPECT_EQ(kept.request.query, request.query);
  EXPECT_EQ(kept.request.content_type, "application/json");
  EXPECT_EQ(kept.request.accept, "text/csv");
  const auto file = folder_ / "requests" / "first.request";
  if (!fs::exists(file)) return;
  std::ofstream(file, std::ios::app) << " ";
  EXPECT_EQ(code_of([&] { store.job_request("first"); }), "store.corrupted");
}

TEST_F(StoreTest, KeepsJobsWithLargeRequestsWhenTheDatabaseIsLost) {
  const std::string body(300'000, 'x');
  {
    Store store(folder_);
    for (const char* id : {"b", "a"}) {
      auto job = new_job(id);
      job.created = id[0] == 'b' ? 1000 : 2000;
      store.add_job(job, store.keep_request(job, {"POST", "/x", {}, {}, {}}, body));
    }
  }
  fs::remove(folder_ / "supple.sqlite");
  const Store store(folder_, recovery());
  const auto unfinished = store.unfinished_jobs();
  ASSERT_EQ(unfinished.size(), 2U);
  EXPECT_EQ(unfinished[0].id, "b") << "the oldest first";
  EXPECT_EQ(store.job_request("a").body, body);
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
    Store store(folder_);
    const auto mesh = store.add_mesh("abc", describe).first.id;
    add_expired(store, "j");
    ASSERT_EQ(fs::file_size(folder_ / "reserve"), 256U << 10);
    fs::remove(folder_ / "reserve");
    fill();
    EXPECT_EQ(code_of([&] { store.remove_expired_jobs(2000, 10); }), "store.full") << "without a reserve";
    EXPECT_EQ(store.job_result("j").body, "42") << "the row is still there, and so is its file";
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

/// Stores whose bytes are limited.
class QuotaTest : public StoreTest {
 protected:
  /// A job that has ended with so many bytes.
  static void add_ended(Store& store, const std::string& id, std::size_t bytes) {
    auto job = new_job(id);
    store.add_job(job);
    job.state = JobState::successful;
    job.finished = now_milliseconds();
    job.expires = job.finished + 1'000'000;
    const Result result{"text/plain", {}, std::string(bytes, 'x')};
    store.finish_job(job, &result);
  }
  /// Bytes of all files in the folder, as the disk tells.
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
    Store store(folder_, recovery());
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
    EXPECT_LT(store.usage().requests, 301'000);
    expect_exact(store, "used");
  }
  std::ofstream(folder_ / "meshes" / "unknown") << "into quarantine";
  Store store(folder_, recovery());
  EXPECT_EQ(store.usage().quarantine, 15);
  expect_exact(store, "opened again");
  fs::remove_all(folder_ / "quarantine");
  store.remove_expired_jobs(0, 100);
  expect_exact(store, "after the quarantine was emptied");
}

TEST_F(QuotaTest, ExpiresTheOldestResultsForWhatIsNew) {
  constexpr std::int64_t result = 1 << 20;
  constexpr std::int64_t limit = 5 * result;  // three results, and the database with its log
  Store store(folder_, recovery(), {limit, 0});
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
  Store store(folder_, recovery(), {limit, 0});
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
  Store store(folder_, recovery(), {0, 1500});
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
    Store store(folder_);
    for (const char* ply : {"unused", "used", "worked on"}) store.add_mesh(ply, describe);
    auto job = new_job("j");
    job.mesh = sha256("worked on");
    store.add_job(job);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  const auto later = now_milliseconds();
  {
    Store store(folder_);
    store.use_mesh(sha256("used"));
  }
  Store store(folder_);
  EXPECT_TRUE(store.remove_unused_meshes(0).empty());
  EXPECT_EQ(store.remove_unused_meshes(later), std::vector{sha256("unused")});
  EXPECT_EQ(store.meshes(10, "").size(), 2U);
  EXPECT_EQ(store.usage().meshes, 13);
  store.remove_job("j");
  EXPECT_EQ(store.remove_unused_meshes(later), std::vector{sha256("worked on")});
}

TEST_F(StoreTest, LetsNothingExpireBecauseTheClockWasSetBetweenTwoProcesses) {
  constexpr std::int64_t eight_days = 8LL * 86'400'000;
  const auto set_clock_back_then = [&](std::int64_t milliseconds) {
    Database(folder_ / "supple.sqlite")
        .execute(("UPDATE clock SET machine_start = machine_start + " + std::to_string(milliseconds)).c_str());
  };
  std::int64_t expires = 0;
  {
    Store store(folder_, recovery());
    store.add_mesh("abc", describe);
    auto job = new_job("j");
    store.add_job(job);
    store.add_job(new_job("unfinished"));
    job.state = JobState::failed;
    job.finished = now_milliseconds();
    job.expires = expires = job.finished + 1'000'000;
    store.finish_job(job, nullptr);
  }
  set_clock_back_then(-eight_days);
  {
    Store store(folder_, recovery());
    EXPECT_EQ(store.job("j")->expires, expires + eight_days) << "it has got no older";
    EXPECT_EQ(store.job("unfinished")->expires, 0);
    EXPECT_TRUE(store.remove_unused_meshes(now_milliseconds() + eight_days - 1'000'000).empty());
    ASSERT_EQ(warnings_.size(), 1U);
    EXPECT_NE(warnings_[0].find("691200 s"), std::string::npos) << warnings_[0];
  }
  set_clock_back_then(30'000);
  EXPECT_EQ(Store(folder_, recovery()).job("j")->expires, expires + eight_days) << "seconds are no setting";
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
  EXPECT_TRUE(store.jobs({JobState::failed}, 100, "", "a").empty());
  EXPECT_EQ(store.jobs({}, 100, "").size(), 10U);
}

}  // namespace
}  // namespace supple::store
