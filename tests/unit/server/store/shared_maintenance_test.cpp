#include "supple/store/maintenance.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "database.h"
#include "replaced_content.h"
#include "shared_store_fixture.h"
#include "supple/store/local_store.h"

namespace supple::store {
namespace {

/// What a client sees of a store, without the times at which its jobs expire.
using Seen = std::map<std::string, std::string>;

class SharedMaintenanceTest : public SharedStoreTest {
 protected:
  SharedStoreLocation place() const { return {database_, folder_ / "data"}; }
  SharedStoreLocation new_place(const std::string& name) const {
    return {PrivatePostgres::of_this_process().new_database(), folder_ / name};
  }
  static SharedStore::Options options_of(const SharedStoreLocation& place) {
    SharedStore::Options options;
    options.database = place.database;
    options.folder = place.folder;
    return options;
  }
  static JobRecord waiting(Store& store, const std::string& id, const std::string& body) {
    auto job = new_job(id, "alice");
    job.client = "client";
    job.session = "session";
    job.idempotency_key = "key of " + id;
    job.request_hash = "hash";
    store.jobs().add_job(
        job, store.blobs().store_request(job, {"POST", "/v1/x", {{"a", "b=c"}}, "text/plain", "*/*"}, body));
    return job;
  }
  static void finish(Store& store, const JobRecord& job, const std::string& answer) {
    const Result result{"text/plain", {{"X-Name", "a: b"}}, answer};
    store.jobs().finish_job(ended(job), &result);
  }
  static void fail(Store& store, JobRecord job) {
    job = ended(job);
    job.state = JobState::failed;
    job.error = "{\"code\":\"x\"}";
    job.error_status = 422;
    store.jobs().finish_job(job, nullptr);
  }
  /// Adds meshes, small and large requests, results and failures, some of owners and some of none.
  static void fill(Store& store) {
    store.meshes().add_mesh("one", describe);
    store.meshes().add_mesh("two", describe, "alice");
    store.meshes().add_mesh("two", describe, "bob");
    waiting(store, "small", std::string("with \0 and \x80", 12));
    waiting(store, "large", std::string(300'000, 'x'));
    finish(store, waiting(store, "done", "body"), "answer");
    finish(store, waiting(store, "empty", "body"), "");
    fail(store, waiting(store, "failed", "body"));
  }
  static Seen seen(const Store& store) {
    Seen all;
    std::string order;
    for (const auto& mesh : store.meshes().meshes(100, {})) {
      order += mesh.id + " ";
      all["mesh " + mesh.id] = store.meshes().mesh_content(mesh.id) + std::to_string(mesh.created) + mesh.description;
      for (const char* owner : {"alice", "bob"})
        all["mesh " + mesh.id] += store.meshes().owns_mesh(mesh.id, owner) ? owner : "nobody";
    }
    for (const auto& job : store.jobs().jobs({}, 100, {})) {
      order += job.id + " ";
      auto& text = all["job " + job.id];
      for (const auto& part :
           {job.kind, job.mesh, std::string(state_name(job.state)), std::string(priority_name(job.priority)), job.error,
            job.client, job.session, job.owner, job.idempotency_key, job.request_hash})
        text += part + "|";
      for (const auto number : {job.created, job.started, job.finished, job.expires, std::int64_t{job.error_status},
                                std::int64_t{job.attempts}})
        text += std::to_string(number) + "|";
      text += std::to_string(job.deadline);
      if (job.finished == 0) {
        const auto request = store.blobs().job_request(job.id);
        text += request.body + request.request.path + request.request.query.at("a");
      } else if (job.state == JobState::successful) {
        const auto result = store.blobs().job_result(job.id);
        text += result.content_type + result.headers.at(0).second + result.body.text();
      }
    }
    all["order"] = order;
    return all;
  }
  Seen seen_in(const SharedStoreLocation& place) const {
    const SharedStore store(options_of(place));
    return seen(store);
  }
  std::string message_of(const std::function<void()>& call) const {
    try {
      call();
    } catch (const std::exception& error) {
      return error.what();
    }
    return "nothing was thrown";
  }
  static std::string problem(const std::string& sentence) { return "{\"detail\":\"" + sentence + "\"}"; }
  CheckReport repair(const SharedStoreLocation& place) const { return repair_shared_store(place, {}, problem); }
  /// The path of the only file whose name contains these letters.
  static fs::path file_of(const fs::path& folder, const std::string& letters) {
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().filename().string().find(letters) != std::string::npos) return entry.path();
    return {};
  }
  static void append(const fs::path& file) { std::ofstream(file, std::ios::app) << "!"; }
  void sql(const std::string& statement) const { PrivatePostgres::rows(database_, statement); }

  const std::string one_ = sha256("one");
};

/// Calls a function with 0, 1, 2, ... on a thread of its own until its scope ends.
class Meanwhile {
 public:
  explicit Meanwhile(std::function<void(int)> call)
      : thread_([this, call = std::move(call)] {
          for (int i = 0; !stops_; ++i) call(i);
        }) {}
  ~Meanwhile() {
    stops_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

/// A way to damage a store that `fill` has filled.
struct Damage {
  std::string name;
  std::string sentence;  ///< part of the sentence with which the check reports it
  std::function<void(const SharedStoreLocation&)> make;
};

std::vector<Damage> damages() {
  const auto id = sha256("one");
  const auto file = [](const SharedStoreLocation& place, const std::string& name) { return place.folder / name; };
  const auto rows = [](const SharedStoreLocation& place, const std::string& sql) {
    PrivatePostgres::rows(place.database, sql);
  };
  std::vector<Damage> all;
  for (const auto& name :
       {"meshes/" + id + ".ply", std::string("results/done.0.result"), std::string("requests/large.request")}) {
    const auto last = fs::path(name).filename().string();
    all.push_back({"missing " + last, "The stored file " + last + " is missing.",
                   [=](const SharedStoreLocation& place) { fs::remove(file(place, name)); }});
    all.push_back({"changed " + last, "The stored file " + last + " has changed since it was written.",
                   [=](const SharedStoreLocation& place) { std::ofstream(file(place, name), std::ios::app) << "!"; }});
    all.push_back({"shortened " + last, "The stored file " + last + " has changed since it was written.",
                   [=](const SharedStoreLocation& place) {
                     fs::resize_file(file(place, name), fs::file_size(file(place, name)) - 1);
                   }});
    const auto unknown = fs::path(name).parent_path() / ("unknown" + fs::path(name).extension().string());
    all.push_back(
        {"unknown " + unknown.string(), "does not name the file " + unknown.filename().string(),
         [=](const SharedStoreLocation& place) { std::ofstream(file(place, unknown.string())) << "unknown"; }});
    all.push_back(
        {"other suffix beside " + last, "does not name the file " + last + ".copy",
         [=](const SharedStoreLocation& place) { fs::copy(file(place, name), file(place, name + ".copy")); }});
  }
  all.push_back(
      {"result of another lease", "does not name the file done.3.result", [=](const SharedStoreLocation& place) {
         fs::copy(file(place, "results/done.0.result"), file(place, "results/done.3.result"));
       }});
  all.push_back(
      {"request of an ended job", "does not name the file done.request", [=](const SharedStoreLocation& place) {
         fs::copy(file(place, "requests/large.request"), file(place, "requests/done.request"));
       }});
  all.push_back({"changed request in the database", "The stored file small.request has changed since it was written.",
                 [=](const SharedStoreLocation& place) {
                   rows(place, "UPDATE jobs SET request = request || $$!$$::bytea WHERE id = $$small$$");
                 }});
  for (const auto& [table, row, bytes] : {std::tuple("meshes", id, "one"), std::tuple("jobs", std::string("done"), ""),
                                          std::tuple("jobs", std::string("large"), "")}) {
    all.push_back({"bytes of " + row, "The database says that the file " + row,
                   [=, table = table, row = row](const SharedStoreLocation& place) {
                     rows(place, std::string("UPDATE ") + table + " SET bytes = bytes + 5 WHERE id = $$" + row + "$$");
                   }});
  }
  for (const char* change : {"state = $$running$$ WHERE id = $$done$$", "state = $$successful$$ WHERE id = $$small$$",
                             "state = $$unheard$$ WHERE id = $$small$$", "finished = 0 WHERE id = $$failed$$",
                             "finished = 5 WHERE id = $$small$$", "state = $$successful$$ WHERE id = $$failed$$",
                             "result_hash = $$$$ WHERE id = $$empty$$", "state = $$failed$$ WHERE id = $$done$$",
                             "request = $$x$$ WHERE id = $$done$$"}) {
    all.push_back({change, "contradicts itself",
                   [=](const SharedStoreLocation& place) { rows(place, std::string("UPDATE jobs SET ") + change); }});
  }
  return all;
}

TEST_F(SharedMaintenanceTest, FindsAndRepairsEveryClassOfDamage) {
  int number = 0;
  for (const auto& damage : damages()) {
    SCOPED_TRACE(damage.name);
    const auto place = new_place("store" + std::to_string(number++));
    {
      SharedStore store(options_of(place));
      fill(store);
    }
    const auto sound = check_shared_store(place);
    EXPECT_EQ(sound.faults, std::vector<std::string>());
    EXPECT_EQ(sound.meshes, 2U);
    EXPECT_EQ(sound.results, 2U);
    EXPECT_EQ(sound.requests, 2U);
    damage.make(place);
    const auto found = check_shared_store(place);
    EXPECT_GE(found.faults.size(), 1U);
    EXPECT_TRUE(std::any_of(found.faults.begin(), found.faults.end(), [&](const auto& fault) {
      return fault.find(damage.sentence) != std::string::npos;
    })) << (found.faults.empty() ? "nothing" : found.faults.front());
    EXPECT_EQ(repair(place).faults, found.faults);
    EXPECT_EQ(check_shared_store(place).faults, std::vector<std::string>()) << "after the repair";
    SharedStore store(options_of(place));
    EXPECT_EQ(store.meshes().mesh_content(sha256("two")), "two");
  }
}

TEST_F(SharedMaintenanceTest, RepairDeletesNoFileAndFailsWhatIsLost) {
  {
    SharedStore store(options());
    fill(store);
  }
  overwrite("meshes/" + one_ + ".ply", "damaged mesh");
  overwrite("results/done.0.result", "damaged result");
  overwrite("meshes/unknown.ply", "unknown mesh");
  sql("UPDATE jobs SET request = $$damaged request$$ WHERE id = $$small$$");
  repair(place());
  EXPECT_EQ(quarantined_in(in_data("quarantine")),
            (std::multiset<std::string>{"damaged mesh", "damaged result", "unknown mesh", "damaged request"}));
  SharedStore store(options());
  EXPECT_FALSE(store.meshes().mesh(one_).has_value()) << "it can be sent again";
  const auto failed = store.jobs().job("done");
  EXPECT_EQ(failed->state, JobState::failed);
  EXPECT_EQ(failed->error_status, 500);
  EXPECT_NE(failed->error.find("done.0.result has changed"), std::string::npos) << failed->error;
  EXPECT_EQ(store.jobs().job("small")->state, JobState::failed);
  EXPECT_EQ(store.blobs().job_result("empty").body.text(), "");
}

TEST_F(SharedMaintenanceTest, RefusesWhatALostServerSaysAfterARepair) {
  SharedStore lost(options(0.05));
  const auto job = waiting(lost, "job", "body");
  wait_milliseconds(100);
  EXPECT_EQ(code_of([&] { repair(place()); }), "store.unavailable") << "it still has the folder";
  fs::remove(in_data("lock"));  // as if the server were on another machine whose file system has no locks
  repair(place());
  const Result result{"text/plain", {}, "answer"};
  EXPECT_FALSE(lost.jobs().finish_job(ended(job), &result));
  SharedStore other(options());
  EXPECT_EQ(other.leases()->lease_jobs({.foreground = 1}).size(), 1U);
}

TEST_F(SharedMaintenanceTest, FindsNothingWrongWhileServersStoreAndRemove) {
  SharedStore one(options());
  SharedStore two(options());
  const Meanwhile writer([&](int i) {
    const auto mesh = one.meshes().add_mesh("mesh " + std::to_string(i), describe).first.id;
    const auto id = std::to_string(i);
    finish(one, waiting(one, id, std::string(i % 7 == 0 ? 300'000 : 10, 'x')), "answer");
    two.meshes().remove_mesh(mesh);
    two.jobs().remove_job(id);
  });
  for (int i = 0; i < 40; ++i) EXPECT_EQ(check_shared_store(place()).faults, std::vector<std::string>());
}

TEST_F(SharedMaintenanceTest, RestoresWhatWasBackedUpToEitherKindOfStore) {
  Seen before;
  {
    SharedStore store(options());
    fill(store);
    before = seen(store);
    std::ofstream(in_data("keys")) << "of clients";
    EXPECT_EQ(back_up_shared_store(place(), folder_ / "backup").faults, std::vector<std::string>());
  }
  ASSERT_EQ(before.size(), 8U);
  EXPECT_EQ(check_folder(folder_ / "backup").faults, std::vector<std::string>());
  EXPECT_EQ(PrivatePostgres::rows(database_, "SELECT count(*) FROM jobs"), "5") << "the store is as it was";

  const auto shared = new_place("shared");
  const auto copy = restore_shared_store(folder_ / "backup", shared, false);
  EXPECT_EQ(copy.faults, std::vector<std::string>());
  EXPECT_EQ(seen_in(shared), before);
  EXPECT_EQ(check_shared_store(shared).faults, std::vector<std::string>());
  EXPECT_TRUE(fs::exists(shared.folder / "keys"));
  EXPECT_FALSE(fs::exists(shared.folder / "restoring"));
  EXPECT_EQ(SharedStore(options_of(shared)).leases()->lease_jobs({.foreground = 10}).size(), 2U)
      << "any server may run them";

  restore(folder_ / "backup", folder_ / "local", false);
  {
    const LocalStore local(folder_ / "local", recovery());
    EXPECT_EQ(seen(local), before);
  }
  back_up(folder_ / "local", folder_ / "local backup");
  const auto again = new_place("again");
  restore_shared_store(folder_ / "local backup", again, false);
  EXPECT_EQ(seen_in(again), before) << "of a store with a database of its own";
  EXPECT_EQ(check_shared_store(again).faults, std::vector<std::string>());
}

/// Each job exists only while its mesh does: a backup that mixes two moments has a job without its mesh.
TEST_F(SharedMaintenanceTest, BacksUpOneMomentWhileServersStoreAndRemove) {
  SharedStore store(options());
  for (int i = 0; i < 60; ++i) store.meshes().add_mesh("constant " + std::to_string(i), describe);
  constexpr int backups = 8;
  {
    const Meanwhile writer([&](int i) {
      auto job = new_job("job " + std::to_string(i));
      job.mesh = store.meshes().add_mesh("mesh " + std::to_string(i), describe).first.id;
      store.jobs().add_job(job, store.blobs().store_request(job, {"POST", "/v1/x", {}, "text/plain", "*/*"},
                                                            std::string(i % 5 == 0 ? 300'000 : 10, 'x')));
      finish(store, job, "answer " + std::to_string(i));
      store.jobs().remove_job("job " + std::to_string(i - 1));
      store.meshes().remove_mesh(sha256("mesh " + std::to_string(i - 1)));
    });
    for (int i = 0; i < backups; ++i) {
      const auto to = folder_ / ("backup" + std::to_string(i));
      EXPECT_EQ(back_up_shared_store(place(), to).faults, std::vector<std::string>());
      EXPECT_EQ(check_folder(to).faults, std::vector<std::string>());
      const Database rows(to / "supple.sqlite");
      Statement orphans(rows, "SELECT count(*) FROM jobs WHERE mesh NOT IN (SELECT id FROM meshes)");
      orphans.step();
      EXPECT_EQ(orphans.integer(0), 0);
    }
  }
  const auto restored = new_place("restored");
  restore_shared_store(folder_ / ("backup" + std::to_string(backups - 1)), restored, false);
  EXPECT_EQ(check_shared_store(restored).faults, std::vector<std::string>());
}

TEST_F(SharedMaintenanceTest, BacksUpTheRestOfADamagedStoreAndSaysWhatIsDamaged) {
  {
    SharedStore store(options());
    fill(store);
  }
  append(file_of(in_data("results"), "done"));
  fs::remove(in_data("meshes/" + one_ + ".ply"));
  const auto copy = back_up_shared_store(place(), folder_ / "backup");
  ASSERT_EQ(copy.faults.size(), 2U);
  EXPECT_EQ(copy.faults[0], "The stored file done.0.result has changed since it was written.");
  EXPECT_EQ(copy.faults[1], "The stored file " + one_ + ".ply is missing.");

  const auto before = PrivatePostgres::rows(database_, "SELECT id, state, hold, revision FROM jobs");
  EXPECT_EQ(code_of([&] { restore_shared_store(folder_ / "backup", place(), true); }), "store.corrupted");
  EXPECT_EQ(PrivatePostgres::rows(database_, "SELECT id, state, hold, revision FROM jobs"), before);
  EXPECT_EQ(files_in(in_data("results")), 2U);
  const auto other = new_place("other");
  EXPECT_EQ(restore_shared_store(folder_ / "backup", other, false).faults.size(), 2U) << "but it fills an empty one";
  EXPECT_EQ(check_shared_store(other).faults.size(), 2U);

  repair_folder(folder_ / "backup", recovery(), problem);
  EXPECT_EQ(restore_shared_store(folder_ / "backup", place(), true).faults, std::vector<std::string>());
  EXPECT_EQ(check_shared_store(place()).faults, std::vector<std::string>());
}

TEST_F(SharedMaintenanceTest, ReplacesAStoreOnlyWhereItIsToldToAndKeepsWhatWasThere) {
  Seen before;
  {
    SharedStore store(options());
    fill(store);
    before = seen(store);
    back_up_shared_store(place(), folder_ / "backup");
    store.meshes().add_mesh("three", describe);
    store.jobs().remove_job("done");
  }
  const auto refusal = [&](const SharedStoreLocation& place) {
    return message_of([&] { restore_shared_store(folder_ / "backup", place, false); });
  };
  EXPECT_EQ(refusal(place()), "There is something in the database already.");
  const auto other = new_place("other");
  { const SharedStore empty(options_of(other)); }
  std::ofstream(other.folder / "keys") << "x";
  EXPECT_NE(refusal(other).find("There is something in "), std::string::npos);

  restore_shared_store(folder_ / "backup", place(), true);
  EXPECT_EQ(seen_in(place()), before);
  EXPECT_EQ(check_shared_store(place()).faults, std::vector<std::string>());
  const auto aside = fs::directory_iterator(in_data("quarantine"))->path();
  EXPECT_TRUE(fs::exists(aside / "meshes" / (sha256("three") + ".ply")));
  const Database rows(aside / "supple.sqlite");
  Statement meshes(rows, "SELECT count(*) FROM meshes");
  meshes.step();
  EXPECT_EQ(meshes.integer(0), 3);
}

TEST_F(SharedMaintenanceTest, OfAllThatFindATableOfAnEarlierVersionOneAddsItsColumns) {
  {
    SharedStore store(options());
    fill(store);
  }
  sql("ALTER TABLE jobs DROP COLUMN priority");
  // Somebody reads the table, so that nobody alters it before all have found it as it was.
  std::thread reader([&] {
    try {
      sql("SELECT count(*) FROM jobs; SELECT pg_sleep(60)");
    } catch (const std::runtime_error&) {
      // It is cancelled below.
    }
  });
  const std::string sleeps = "pg_stat_activity WHERE wait_event = $$PgSleep$$";
  const auto wait_for = [&](const std::string& rows, const char* count) {
    while (PrivatePostgres::rows(database_, "SELECT count(*) FROM " + rows) != count) std::this_thread::yield();
  };
  wait_for(sleeps, "1");
  std::array<std::string, 3> messages;
  std::vector<std::thread> users;
  users.emplace_back([&] { messages[0] = message_of([&] { check_shared_store(place()); }); });
  users.emplace_back([&] { messages[1] = message_of([&] { back_up_shared_store(place(), folder_ / "backup"); }); });
  users.emplace_back([&] { messages[2] = message_of([&] { SharedStore server(options()); }); });
  wait_for("pg_locks WHERE NOT granted", "3");
  sql("SELECT pg_cancel_backend(pid) FROM " + sleeps);
  for (auto& user : users) user.join();
  reader.join();
  for (const auto& message : messages) EXPECT_EQ(message, "nothing was thrown");
  EXPECT_EQ(check_shared_store(place()).faults, std::vector<std::string>());
}

TEST_F(SharedMaintenanceTest, ASnapshotAndAMigrationDoNotWaitForEachOther) {
  {
    SharedStore store(options());
    fill(store);
  }
  sql("ALTER TABLE jobs DROP COLUMN priority");
  // The lock that a backup has while it copies: who would alter the table waits before it has locked anything else.
  std::thread backup([&] {
    try {
      sql("SELECT pg_advisory_xact_lock_shared(hashtextextended($$supple tables$$, 0)); "
          "LOCK TABLE meshes, mesh_owners, jobs IN SHARE MODE; SELECT pg_sleep(60)");
    } catch (const std::runtime_error&) {
      // It is cancelled below.
    }
  });
  const std::string sleeps = "pg_stat_activity WHERE wait_event = $$PgSleep$$";
  const auto count = [&](const std::string& rows) {
    return PrivatePostgres::rows(database_, "SELECT count(*) FROM " + rows);
  };
  while (count(sleeps) != "1") std::this_thread::yield();
  std::string message;
  std::thread server([&] { message = message_of([&] { SharedStore store(options()); }); });
  while (count("pg_locks WHERE NOT granted") != "1") std::this_thread::yield();
  EXPECT_EQ(count("pg_locks WHERE NOT granted AND locktype = $$advisory$$"), "1");
  EXPECT_NE(count("jobs"), "0") << "the backup can read the table";
  sql("SELECT pg_cancel_backend(pid) FROM " + sleeps);
  server.join();
  backup.join();
  EXPECT_EQ(message, "nothing was thrown");
}

TEST_F(SharedMaintenanceTest, RefusesToReplaceOrRepairWhatServersUse) {
  {
    SharedStore store(options());
    fill(store);
    back_up_shared_store(place(), folder_ / "backup");
    for (const auto& call : {std::function([&] { repair(place()); }),
                             std::function([&] { restore_shared_store(folder_ / "backup", place(), true); })})
      EXPECT_NE(message_of(call).find("in use by"), std::string::npos) << message_of(call);
  }
  // A server on another machine, whose lock of the folder is not seen here.
  sql("INSERT INTO servers VALUES ($$elsewhere$$, now() + interval $$1 hour$$)");
  const std::string sentence = "The database is in use by 1 server; one that was killed is in it until its lease ends.";
  EXPECT_EQ(message_of([&] { repair(place()); }), sentence);
  EXPECT_EQ(message_of([&] { restore_shared_store(folder_ / "backup", place(), true); }), sentence);
  EXPECT_EQ(check_shared_store(place()).faults, std::vector<std::string>());
  sql("UPDATE servers SET until = now() - interval $$1 second$$");
  restore_shared_store(folder_ / "backup", place(), true);
  repair(place());
}

TEST_F(SharedMaintenanceTest, RefusesWhatIsNoStoreAndWhatIsNoBackup) {
  const auto message = [&](const SharedStoreLocation& place) { return message_of([&] { check_shared_store(place); }); };
  const auto empty = new_place("empty");
  fs::create_directories(empty.folder);
  EXPECT_EQ(message(empty), "There is no store in the database.");
  EXPECT_EQ(PrivatePostgres::rows(empty.database, "SELECT count(*) FROM pg_tables WHERE schemaname = $$public$$"), "0");
  EXPECT_TRUE(fs::is_empty(empty.folder));
  {
    SharedStore store(options());
    fill(store);
    const SharedStore other(options_of(empty));
  }
  EXPECT_NE(message({database_, empty.folder}).find("is not the one that this database belongs to"), std::string::npos);
  back_up_shared_store(place(), folder_ / "backup");
  EXPECT_NE(message({database_, folder_ / "backup"}).find("belongs to a server with a database of its own"),
            std::string::npos);
  EXPECT_NE(message_of([&] { back_up_shared_store(place(), folder_ / "backup"); }).find("There is something in"),
            std::string::npos);
  const auto refusal = [&](const fs::path& from) {
    return message_of([&] { restore_shared_store(from, new_place("new"), false); });
  };
  EXPECT_NE(refusal(in_data("")).find("There is no database in"), std::string::npos);
  fs::copy(folder_ / "backup", folder_ / "incomplete", fs::copy_options::recursive);
  fs::remove(folder_ / "incomplete" / "backup");
  EXPECT_NE(refusal(folder_ / "incomplete").find("no complete backup"), std::string::npos);
  sql("UPDATE store SET version = 2");
  EXPECT_NE(message(place()).find("later version"), std::string::npos);
}

TEST_F(SharedMaintenanceTest, RefusesABackupWhoseDatabaseHasChanged) {
  for (const bool is_shared : {true, false}) {
    const auto backup = folder_ / (is_shared ? "shared backup" : "local backup");
    if (is_shared) {
      SharedStore store(options());
      fill(store);
      back_up_shared_store(place(), backup);
    } else {
      {
        LocalStore store(folder_ / "local", recovery());
        fill(store);
      }
      back_up(folder_ / "local", backup);
    }
    Database(backup / "supple.sqlite").execute("UPDATE jobs SET error = 'other' WHERE id = 'failed'");
    const std::string sentence = "The stored file supple.sqlite has changed since it was written.";
    EXPECT_EQ(message_of([&] { restore_shared_store(backup, new_place("new"), false); }), sentence);
    EXPECT_EQ(message_of([&] { restore(backup, folder_ / "new local", false); }), sentence);
    std::ofstream(backup / "backup") << "supple-server backup of an earlier version, which told no hash\n";
    EXPECT_EQ(restore_shared_store(backup, new_place(is_shared ? "a" : "b"), false).faults, std::vector<std::string>());
  }
}

TEST_F(SharedMaintenanceTest, ReplacesNothingWhereTheDatabaseRefusesARow) {
  Seen before;
  {
    SharedStore store(options());
    fill(store);
    before = seen(store);
  }
  back_up_shared_store(place(), folder_ / "backup");
  Database(folder_ / "backup" / "supple.sqlite")
      .execute("UPDATE jobs SET error = CAST(x'ff' AS TEXT) WHERE id = 'failed'");
  std::ofstream(folder_ / "backup" / "backup") << "without a hash\n";
  EXPECT_EQ(code_of([&] { restore_shared_store(folder_ / "backup", place(), true); }), "store.unavailable");
  EXPECT_EQ(seen_in(place()), before);
  EXPECT_EQ(check_shared_store(place()).faults, std::vector<std::string>());
}

TEST_F(SharedMaintenanceTest, LeavesTheStoreAsItWasWhereAFileCannotTakeItsPlace) {
  Seen before;
  {
    SharedStore store(options());
    fill(store);
    before = seen(store);
    back_up_shared_store(place(), folder_ / "backup");
  }
  std::ofstream(folder_ / "backup" / "restoring") << "of the name of the folder in which the backup waits";
  EXPECT_THROW(restore_shared_store(folder_ / "backup", place(), true), fs::filesystem_error);
  EXPECT_EQ(seen_in(place()), before);
  EXPECT_EQ(check_shared_store(place()).faults, std::vector<std::string>());
}

TEST_F(SharedMaintenanceTest, MovesBackWhatItHasMovedWhereNotAllOfItSucceeds) {
  std::ofstream(folder_ / "a") << "a";
  fs::create_directories(folder_ / "full");
  std::ofstream(folder_ / "full" / "b") << "b";
  Moves moves;
  moves.move(folder_ / "a", folder_ / "aside" / "a");
  EXPECT_THROW(moves.move(folder_ / "aside", folder_ / "full"), fs::filesystem_error);
  moves.undo();
  EXPECT_TRUE(fs::exists(folder_ / "a"));
}

TEST_F(SharedMaintenanceTest, PrintsNoPassword) {
  fs::create_directories(in_data(""));
  for (const char* address :
       {"postgresql://supple:secret@localhost:secret/x", "postgresql://supple:se%cret@localhost/x",
        "postgresql://supple:se@secret@localhost/x", "postgresql://supple:54/secret@localhost/x",
        "postgresql://supple:se?secret@localhost/x", "postgresql://supple:secret@127.0.0.1:1/x",
        "host=127.0.0.1 port=1 user=supple password=secret", "password=secret host=/nowhere", "password='secret",
        "host=/nowhere password=a secret"}) {
    const auto message = message_of([&] { check_shared_store({address, folder_ / "data"}); });
    EXPECT_EQ(message.find("cret"), std::string::npos) << message;
    EXPECT_NE(message, "nothing was thrown");
  }
}

}  // namespace
}  // namespace supple::store
