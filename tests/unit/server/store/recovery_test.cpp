#include <sys/wait.h>

#include <csignal>
#include <new>
#include <sstream>

#include "database.h"
#include "store_fixture.h"

namespace supple::store {
namespace {

TEST_F(StoreTest, LosesNothingThatWasFinishedWhenTheProcessIsKilled) {
  const pid_t child = fork();
  if (child == 0) {
    LocalStore store(folder_);
    store.meshes().add_mesh("abc", describe);
    auto job = new_job("done");
    store.jobs().add_job(job);
    store.jobs().add_job(new_job("open"));
    job.state = JobState::successful;
    const Result result{"text/plain", {}, "result"};
    store.jobs().finish_job(job, &result);
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  LocalStore store(folder_);
  EXPECT_EQ(store.meshes().meshes(10, "").size(), 1U);
  EXPECT_EQ(store.blobs().job_result("done").body.text(), "result");
  ASSERT_EQ(store.jobs().unfinished_jobs().size(), 1U);
  EXPECT_EQ(store.jobs().unfinished_jobs()[0].id, "open");
}

TEST_F(StoreTest, RemovesOnlyWhatWasNeverAcknowledged) {
  {
    LocalStore store(folder_);
    store.jobs().add_job(new_job("open"));
  }
  for (const char* name : {"meshes/ab.ply.0.part", "results/x.result.1.part", "results/open.result"})
    std::ofstream(folder_ / name) << "x";
  const LocalStore store(folder_, recovery());
  EXPECT_TRUE(fs::is_empty(folder_ / "meshes"));
  EXPECT_TRUE(fs::is_empty(folder_ / "results"));
  EXPECT_FALSE(fs::exists(folder_ / "quarantine"));
}

TEST_F(StoreTest, MovesUnknownFilesIntoQuarantine) {
  { LocalStore store(folder_); }
  const auto wrong_hash = std::string(64, '0') + ".ply";
  const auto no_mesh = sha256("no mesh") + ".ply";
  std::ofstream(folder_ / "meshes" / wrong_hash) << "abc";
  std::ofstream(folder_ / "meshes" / no_mesh) << "no mesh";
  std::ofstream(folder_ / "meshes" / "notes.txt") << "mine";
  std::ofstream(folder_ / "results" / "x.result") << "first";
  { const LocalStore store(folder_, recovery()); }
  std::ofstream(folder_ / "results" / "x.result") << "second";
  const LocalStore store(folder_, recovery());
  EXPECT_TRUE(store.meshes().meshes(10, "").empty());
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
    LocalStore store(folder_);
    before = store.meshes().add_mesh("abc", describe).first;
  }
  fs::remove(folder_ / "supple.sqlite");
  const LocalStore store(folder_, recovery());
  const auto after = store.meshes().mesh(before.id);
  ASSERT_TRUE(after);
  EXPECT_EQ(after->description, before.description);
  EXPECT_NEAR(static_cast<double>(after->created), static_cast<double>(before.created), 5000);
  EXPECT_EQ(store.meshes().mesh_content(before.id), "abc");
}

TEST_F(StoreTest, LeavesAMeshWhereItIsWhileThereIsNoMemoryToIndexIt) {
  std::string id;
  {
    LocalStore store(folder_);
    id = store.meshes().add_mesh("abc", describe).first.id;
  }
  fs::remove(folder_ / "supple.sqlite");
  auto poor = recovery();
  poor.describe = [](const std::string&, const std::string&, std::int64_t) -> std::string { throw std::bad_alloc(); };
  EXPECT_FALSE(LocalStore(folder_, poor).meshes().mesh(id));
  EXPECT_TRUE(fs::exists(folder_ / "meshes" / (id + ".ply")));
  EXPECT_TRUE(LocalStore(folder_, recovery()).meshes().mesh(id)) << "the next start has the memory";
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
      LocalStore store(folder_);
      mesh = store.meshes().add_mesh("abc", describe).first.id;
      auto job = new_job("j");
      store.jobs().add_job(job);
      job.state = JobState::successful;
      const Result result{"text/plain", {}, "42"};
      store.jobs().finish_job(job, &result);
    }
    damage();
    LocalStore store(folder_, recovery());
    EXPECT_EQ(store.meshes().mesh_content(mesh), "abc") << name;
    EXPECT_EQ(store.meshes().meshes(10, "").size(), 1U) << name;
    EXPECT_EQ(store.blobs().job_result("j").body.text(), "42") << name;
    EXPECT_EQ(quarantined().size(), 1U) << name << ": the database";
    EXPECT_NE(warnings_.at(0).find("damaged"), std::string::npos) << warnings_.at(0);
    EXPECT_EQ(store.meshes().add_mesh("more", describe).second, true) << name << ": it is a store again";
  }
}

TEST_F(StoreTest, AnswersResultsOfALostDatabaseAgainInTheirOrder) {
  std::vector<JobRecord> before;
  const Result result{"application/octet-stream", {{"A", "1"}, {"B", "x: y"}}, std::string("\0\n\xFF", 3)};
  {
    LocalStore store(folder_);
    for (int i = 0; i < 5; ++i) {
      auto job = new_job("j" + std::to_string(9 - i));
      job.created = 1000 + i;
      job.client = "127.0.0.1";
      job.session = "line\nend: \\";
      job.attempts = 1;
      store.jobs().add_job(job);
      job.state = JobState::successful;
      job.started = 2000;
      job.finished = 3000;
      job.expires = 4'000'000'000'000;
      store.jobs().finish_job(job, &result);
      before.push_back(job);
    }
  }
  fs::remove(folder_ / "supple.sqlite");
  const LocalStore store(folder_, recovery());
  const auto after = store.jobs().jobs({}, 10, "");
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    const auto& expected = before[before.size() - 1 - i];
    EXPECT_EQ(after[i].id, expected.id);
    EXPECT_EQ(after[i].state, JobState::successful);
    EXPECT_EQ(after[i].session, expected.session);
    EXPECT_EQ(after[i].expires, expected.expires);
    const auto again = store.blobs().job_result(expected.id);
    EXPECT_EQ(again.body.text(), result.body);
    EXPECT_EQ(again.content_type, result.content_type);
    EXPECT_EQ(again.headers, result.headers);
  }
}

TEST_F(StoreTest, PutsChangedResultsOfALostDatabaseIntoQuarantine) {
  {
    LocalStore store(folder_);
    for (const char* id : {"head", "body", "name"}) {
      auto job = new_job(id);
      store.jobs().add_job(job);
      job.state = JobState::successful;
      const Result result{"text/plain", {}, "forty-two"};
      store.jobs().finish_job(job, &result);
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
  const LocalStore store(folder_, recovery());
  EXPECT_TRUE(store.jobs().jobs({}, 10, "").empty());
  EXPECT_TRUE(fs::is_empty(folder_ / "results"));
  EXPECT_EQ(quarantined().size(), 3U);
}

TEST_F(StoreTest, ReadsAFolderOfTheVersionBefore) {
  {
    LocalStore store(folder_);
    auto job = new_job("old");
    store.jobs().add_job(job);
    job.state = JobState::successful;
    const Result result{"text/plain", {{"A", "1"}}, "42"};
    store.jobs().finish_job(job, &result);
  }
  const auto change = [&](const char* statement) { Database(folder_ / "supple.sqlite").execute(statement); };
  for (const char* statement : {"ALTER TABLE jobs DROP COLUMN client", "ALTER TABLE jobs DROP COLUMN session",
                                "ALTER TABLE jobs DROP COLUMN attempts", "ALTER TABLE jobs DROP COLUMN priority",
                                "ALTER TABLE meshes DROP COLUMN used", "PRAGMA user_version = 1"})
    change(statement);
  std::ofstream(folder_ / "results" / "old.result") << "42";  // a file of version 1, which is the body alone
  {
    LocalStore store(folder_, recovery());
    EXPECT_EQ(store.blobs().job_result("old").body.text(), "42");
    store.jobs().add_job(new_job("new"));
    EXPECT_EQ(store.jobs().unfinished_jobs().size(), 1U);
    EXPECT_EQ(store.jobs().job("old")->priority, Priority::normal);
    EXPECT_TRUE(warnings_.empty());
  }
  change("PRAGMA user_version = 3");
  EXPECT_EQ(code_of([&] { LocalStore store(folder_, recovery()); }), "store.unavailable") << "of a later version";
}

TEST_F(StoreTest, LetsNothingExpireBecauseTheClockWasSetBetweenTwoProcesses) {
  constexpr std::int64_t eight_days = 8LL * 86'400'000;
  const auto set_clock_back_then = [&](std::int64_t milliseconds) {
    Database(folder_ / "supple.sqlite")
        .execute(("UPDATE clock SET machine_start = machine_start + " + std::to_string(milliseconds)).c_str());
  };
  std::int64_t expires = 0;
  {
    LocalStore store(folder_, recovery());
    store.meshes().add_mesh("abc", describe);
    auto job = new_job("j");
    store.jobs().add_job(job);
    store.jobs().add_job(new_job("unfinished"));
    job.state = JobState::failed;
    job.finished = now_milliseconds();
    job.expires = expires = job.finished + 1'000'000;
    store.jobs().finish_job(job, nullptr);
  }
  set_clock_back_then(-eight_days);
  {
    LocalStore store(folder_, recovery());
    EXPECT_EQ(store.jobs().job("j")->expires, expires + eight_days) << "it has got no older";
    EXPECT_EQ(store.jobs().job("unfinished")->expires, 0);
    EXPECT_TRUE(store.meshes().remove_unused_meshes(now_milliseconds() + eight_days - 1'000'000).empty());
    ASSERT_EQ(warnings_.size(), 1U) << ::testing::PrintToString(warnings_);
    EXPECT_NE(warnings_[0].find("691200 s"), std::string::npos) << warnings_[0];
  }
  set_clock_back_then(30'000);
  EXPECT_EQ(LocalStore(folder_, recovery()).jobs().job("j")->expires, expires + eight_days) << "seconds are no setting";
}

}  // namespace
}  // namespace supple::store
