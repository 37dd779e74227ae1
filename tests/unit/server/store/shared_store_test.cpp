#include "supple/store/shared_store.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "shared_store_fixture.h"
#include "silent_database.h"
#include "supple/store/local_store.h"

namespace supple::store {
namespace {

TEST_F(SharedStoreTest, ShowsMeshesToAllServers) {
  SharedStore one(options());
  SharedStore two(options());
  const auto added = one.meshes().add_mesh("ply", describe, "alice");
  const auto& record = added.first;
  EXPECT_TRUE(added.second);
  EXPECT_EQ(two.meshes().mesh_content(record.id), "ply");
  EXPECT_FALSE(two.meshes().add_mesh("ply", describe, "alice").second) << "uploading twice is one mesh";
  EXPECT_TRUE(two.meshes().add_mesh("ply", describe, "bob").second);
  EXPECT_TRUE(one.meshes().owns_mesh(record.id, "bob"));
  EXPECT_EQ(one.meshes().meshes(10, {}, "carol").size(), 0U);
  EXPECT_EQ(one.meshes().meshes(10, {}, "bob").size(), 1U);
  EXPECT_FALSE(one.meshes().is_last_owner_of_mesh(record.id, "bob"));

  EXPECT_TRUE(one.meshes().may_have_mesh(record.id));
  EXPECT_TRUE(two.meshes().remove_mesh(record.id, "alice"));
  EXPECT_FALSE(two.meshes().remove_mesh(record.id, "alice"));
  EXPECT_TRUE(one.meshes().is_last_owner_of_mesh(record.id, "bob"));
  EXPECT_TRUE(one.meshes().mesh(record.id).has_value());
  EXPECT_TRUE(two.meshes().remove_mesh(record.id, "bob"));
  EXPECT_FALSE(one.meshes().mesh(record.id).has_value());
  EXPECT_EQ(files_in(folder_ / "data" / "meshes"), 0U);
  EXPECT_EQ(code_of([&] { one.meshes().mesh_content(record.id); }), "mesh.not_found");
  wait_milliseconds(1100);
  EXPECT_FALSE(one.meshes().may_have_mesh(record.id)) << "within a second";
}

TEST_F(SharedStoreTest, PagesThroughMeshesAndJobsFromTheNewest) {
  SharedStore store(options());
  std::vector<std::string> ids;
  for (const char* ply : {"a", "b", "c"}) ids.push_back(store.meshes().add_mesh(ply, describe).first.id);
  const auto first = store.meshes().meshes(2, {});
  ASSERT_EQ(first.size(), 2U);
  EXPECT_EQ(first[0].id, ids[2]);
  EXPECT_EQ(store.meshes().meshes(2, first[1].id).at(0).id, ids[0]);

  store.jobs().add_job(new_job("one", "alice"));
  store.jobs().add_job(new_job("two"));
  EXPECT_EQ(store.jobs().jobs({}, 10, {}).at(0).id, "two");
  EXPECT_EQ(store.jobs().jobs({}, 10, "two").at(0).id, "one");
  EXPECT_EQ(store.jobs().jobs({JobState::running}, 10, {}).size(), 0U);
  EXPECT_EQ(store.jobs().jobs({JobState::accepted}, 10, {}, "alice").size(), 1U);
  EXPECT_TRUE(store.jobs().owns_job("one", "alice"));
  EXPECT_FALSE(store.jobs().owns_job("two", "alice"));
}

TEST_F(SharedStoreTest, KeepsAJobWithItsRequestAndItsResult) {
  SharedStore one(options());
  SharedStore two(options());
  for (const std::size_t size : {std::size_t{10}, std::size_t{300'000}}) {
    const auto id = "job" + std::to_string(size);
    std::string body(size, 'x');
    body[3] = '\0';
    body[4] = '\x80';
    auto job = new_job(id, "alice");
    job.client = "client";
    job.session = "session";
    job.priority = Priority::background;
    const JobRequest request{"POST", "/v1/x", {{"a", "b=c"}}, "text/plain", "*/*"};
    EXPECT_TRUE(one.jobs().add_job(job, one.blobs().store_request(job, request, body)));
    EXPECT_TRUE(two.blobs().has_request(id));
    EXPECT_EQ(files_in(folder_ / "data" / "requests"), size > 100'000 ? 1U : 0U) << "small ones are in the database";
    const auto stored = two.blobs().job_request(id);
    EXPECT_EQ(stored.body, body);
    EXPECT_EQ(stored.request.query, request.query);
    const auto seen = two.jobs().job(id);
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->owner, "alice");
    EXPECT_EQ(seen->client, "client");
    EXPECT_EQ(seen->session, "session");
    EXPECT_EQ(seen->deadline, job.deadline);
    EXPECT_EQ(seen->priority, Priority::background);

    EXPECT_FALSE(two.jobs().remove_job(id)) << "it has not ended";
    const auto revision = two.leases()->job_progress(id)->revision;
    const Result result{"text/plain", {{"ETag", "\"1\""}}, "answer"};
    EXPECT_TRUE(one.jobs().finish_job(ended(job), &result));
    const Result again{"text/plain", {}, "something else"};
    EXPECT_FALSE(one.jobs().finish_job(ended(job), &again)) << "it has ended";
    const auto found = two.blobs().job_result(id);
    EXPECT_EQ(found.body.text(), "answer");
    EXPECT_EQ(found.headers, result.headers);
    EXPECT_FALSE(two.blobs().has_request(id));
    EXPECT_GT(two.leases()->job_progress(id)->revision, revision) << "who waits for it is told";
    overwrite("requests/" + id + ".request", "left by a server that was lost in that moment");
    EXPECT_EQ(two.jobs().job(id)->state, JobState::successful);
    EXPECT_TRUE(two.jobs().remove_job(id));
    EXPECT_FALSE(one.jobs().remove_job(id));
    EXPECT_EQ(code_of([&] { one.blobs().job_result(id); }), "job.not_found");
  }
  EXPECT_EQ(files_in(folder_ / "data" / "results"), 0U);
  EXPECT_EQ(files_in(folder_ / "data" / "requests"), 0U);
}

TEST_F(SharedStoreTest, TakesTheJobsOfAServerThatIsNotHeardOf) {
  SharedStore lost(options(0.05));
  SharedStore other(options());
  auto job = running(lost, "job");
  wait_milliseconds(100);
  const auto taken = other.leases()->lease_jobs({.foreground = 0});
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].id, "job");
  EXPECT_EQ(taken[0].state, JobState::running);
  EXPECT_EQ(taken[0].attempts, 1);
  EXPECT_EQ(taken[0].fencing_token, job.fencing_token + 1);
  EXPECT_EQ(other.leases()->lease_jobs({.foreground = 5}).size(), 0U) << "it has them already";

  // The lost server goes on without knowing that it was lost: its reports are refused.
  const Result late{"text/plain", {}, "late"};
  EXPECT_FALSE(lost.jobs().update_job(job));
  EXPECT_FALSE(lost.jobs().finish_job(ended(job), &late));
  EXPECT_EQ(lost.leases()->renew_leases({}).size(), 0U);
  EXPECT_EQ(other.jobs().job("job")->finished, 0);
  const Result right{"text/plain", {}, "right"};
  EXPECT_TRUE(other.jobs().finish_job(ended(taken[0]), &right));
  EXPECT_FALSE(lost.jobs().finish_job(ended(job), &late));
  EXPECT_EQ(lost.blobs().job_result("job").body.text(), "right");
  EXPECT_EQ(files_in(folder_ / "data" / "results"), 1U) << "the late one has left no file";
}

TEST_F(SharedStoreTest, RemovesTheFileOfAServerThatWasLostBeforeItsRow) {
  SharedStore lost(options(0.05));
  SharedStore other(options());
  running(lost, "job");
  std::ofstream(folder_ / "data" / "results" / "job.0.result") << "its row is missing";
  wait_milliseconds(100);
  const auto taken = other.leases()->lease_jobs({.foreground = 0});
  ASSERT_EQ(taken.size(), 1U);
  const Result result{"text/plain", {}, "right"};
  EXPECT_TRUE(other.jobs().finish_job(ended(taken[0]), &result));
  EXPECT_EQ(files_in(folder_ / "data" / "results"), 1U);
  EXPECT_EQ(other.blobs().job_result("job").body.text(), "right");
}

TEST_F(SharedStoreTest, AddsTheColumnsThatTablesOfAnEarlierVersionLack) {
  SharedStore(options()).jobs().add_job(new_job("old"), "request");
  PrivatePostgres::rows(database_, "ALTER TABLE jobs DROP COLUMN priority");
  SharedStore store(options());
  EXPECT_EQ(store.jobs().job("old")->priority, Priority::normal);
  auto job = new_job("new");
  job.priority = Priority::interactive;
  store.jobs().add_job(job, "request");
  EXPECT_EQ(store.jobs().job("new")->priority, Priority::interactive);
}

TEST_F(SharedStoreTest, GivesTheMostUrgentJobsToWorkersThatHaveTimeForThem) {
  SharedStore one(options());
  SharedStore two(options());
  for (const auto priority : {Priority::background, Priority::normal, Priority::interactive}) {
    auto job = new_job(std::string(priority_name(priority)));
    job.priority = priority;
    one.jobs().add_job(job, "request");
  }
  const auto urgent = two.leases()->lease_jobs({.foreground = 1});
  ASSERT_EQ(urgent.size(), 1U);
  EXPECT_EQ(urgent[0].id, "interactive") << "though it came last";
  const auto quiet = two.leases()->lease_jobs({.background = 3});
  ASSERT_EQ(quiet.size(), 1U) << "the normal one is not for workers of the background";
  EXPECT_EQ(quiet[0].id, "background");
  EXPECT_EQ(two.leases()->lease_jobs({.foreground = 3}).at(0).id, "normal");
}

TEST_F(SharedStoreTest, LeavesJobsToAServerThatIsHeardOf) {
  SharedStore one(options());
  SharedStore two(options());
  running(one, "runs");
  one.jobs().add_job(new_job("waits"), "request");
  EXPECT_EQ(two.leases()->lease_jobs({.foreground = 0}).size(), 0U) << "it has no time for them";
  const auto taken = two.leases()->lease_jobs({.foreground = 5});
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].id, "waits");
  EXPECT_EQ(two.leases()->lease_jobs({.foreground = 5}).size(), 0U)
      << "its own are not taken again, though they have not begun";
  const auto held = one.leases()->renew_leases({});
  ASSERT_EQ(held.size(), 1U);
  EXPECT_EQ(held[0].id, "runs");
}

TEST_F(SharedStoreTest, TakesEachJobOnce) {
  SharedStore source(options());
  SharedStore one(options());
  SharedStore two(options());
  constexpr int jobs = 60;
  for (int i = 0; i < jobs; ++i) {
    const auto job = new_job("job" + std::to_string(i));
    source.jobs().add_job(job, "request");
    source.jobs().update_job(job);  // the job waits, and no server has it
  }
  std::atomic<int> taken{0};
  const auto take = [&](SharedStore& server) {
    for (int i = 0; i < jobs; ++i) taken += static_cast<int>(server.leases()->lease_jobs({.foreground = 0}).size());
  };
  std::thread first([&] { take(one); });
  take(two);
  first.join();
  EXPECT_EQ(taken, jobs);
  EXPECT_EQ(one.leases()->renew_leases({}).size() + two.leases()->renew_leases({}).size(),
            static_cast<std::size_t>(jobs));
}

TEST_F(SharedStoreTest, FreesItsJobsAtItsEnd) {
  SharedStore other(options());
  {
    SharedStore ends(options());
    ends.jobs().add_job(new_job("waits"), "request");
    auto job = running(ends, "put back");
    job.state = JobState::accepted;
    EXPECT_TRUE(ends.jobs().update_job(job));
    EXPECT_EQ(other.leases()->lease_jobs({.foreground = 0}).size(), 1U) << "one that is put back is free at once";
  }
  EXPECT_EQ(other.leases()->lease_jobs({.foreground = 0}).size(), 1U);
}

TEST_F(SharedStoreTest, TellsOtherServersHowFarAJobIs) {
  SharedStore one(options());
  SharedStore two(options());
  running(one, "job");
  const auto before = two.leases()->job_progress("job");
  one.leases()->renew_leases({{"job", 0.25, "solving", "{\"a\":1}"}});
  const auto after = two.leases()->job_progress("job");
  ASSERT_TRUE(before && after);
  EXPECT_EQ(after->fraction, 0.25);
  EXPECT_EQ(after->stage, "solving");
  EXPECT_EQ(after->partial, "{\"a\":1}");
  EXPECT_GT(after->revision, before->revision);
  two.leases()->renew_leases({{"job", 0.5, "of another", ""}});
  EXPECT_EQ(one.leases()->job_progress("job")->fraction, 0.25) << "only who holds it tells how far it is";
}

TEST_F(SharedStoreTest, DismissesAJobOfAnotherServer) {
  SharedStore one(options());
  SharedStore two(options());
  const auto job = running(one, "job");
  const auto dismissed = two.leases()->dismiss_job("job", 5, 6);
  ASSERT_TRUE(dismissed);
  EXPECT_EQ(dismissed->state, JobState::dismissed);
  EXPECT_EQ(dismissed->expires, 6);
  EXPECT_GT(dismissed->fencing_token, job.fencing_token) << "a file that its server still writes is not its result";
  EXPECT_FALSE(two.leases()->dismiss_job("job", 5, 6)) << "it has ended";
  EXPECT_EQ(one.leases()->renew_leases({}).size(), 0U);
  const Result late{"text/plain", {}, "late"};
  EXPECT_FALSE(one.jobs().finish_job(ended(job), &late));
  EXPECT_EQ(two.jobs().job("job")->state, JobState::dismissed);
}

TEST_F(SharedStoreTest, KnowsAJobByItsKeyOfIdempotency) {
  SharedStore one(options());
  SharedStore two(options());
  auto job = new_job("first");
  job.idempotency_key = "key";
  job.request_hash = "hash";
  EXPECT_TRUE(one.jobs().add_job(job));
  EXPECT_EQ(two.jobs().job_of_key("key")->id, "first");
  EXPECT_EQ(two.jobs().job_of_key("key")->request_hash, "hash");
  job.id = "second";
  EXPECT_FALSE(two.jobs().add_job(job));
  EXPECT_FALSE(two.jobs().job("second").has_value());
  EXPECT_FALSE(two.jobs().job_of_key("").has_value()) << "jobs without a key are not one job";
}

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

TEST_F(SharedStoreTest, NoticesAResultThatHasChanged) {
  SharedStore store(options());
  const Result result{"text/plain", {}, "answer"};
  store.jobs().finish_job(ended(running(store, "job")), &result);
  const auto file = fs::directory_iterator(folder_ / "data" / "results")->path();
  std::ofstream(file, std::ios::app) << "!";
  EXPECT_EQ(code_of([&] { store.blobs().job_result("job"); }), "store.corrupted");
}

TEST_F(SharedStoreTest, RefusesTheFormerTokenOfAJobThatAServerLostAndTookAgain) {
  SharedStore one(options());
  SharedStore two(options());
  const auto former = running(one, "job");
  const auto put_back = [](SharedStore& server, JobRecord job) {
    job.state = JobState::accepted;
    EXPECT_TRUE(server.jobs().update_job(job));
  };
  put_back(one, former);
  put_back(two, two.leases()->lease_jobs({.foreground = 1}).at(0));
  const auto present = one.leases()->lease_jobs({.foreground = 1}).at(0);
  EXPECT_FALSE(one.jobs().update_job(former));
  const Result result{"text/plain", {}, "answer"};
  EXPECT_FALSE(one.jobs().finish_job(ended(former), &result));
  EXPECT_TRUE(one.jobs().finish_job(ended(present), &result));
}

TEST_F(SharedStoreTest, TakesNoNewJobsBesideThoseOfALostServerBeyondItsTime) {
  SharedStore waiting(options());
  SharedStore lost(options(0.05));
  SharedStore other(options());
  for (const char* id : {"a", "b", "c"}) running(lost, id);
  waiting.jobs().add_job(new_job("waits"), "request");
  wait_milliseconds(100);
  EXPECT_EQ(other.leases()->lease_jobs({.foreground = 1}).size(), 3U);
  EXPECT_EQ(other.leases()->lease_jobs({.foreground = 1}).at(0).id, "waits");
}

TEST_F(SharedStoreTest, TakesTheJobsOfALostServerByTheirKind) {
  SharedStore lost(options(0.05));
  SharedStore other(options());
  const auto add = [&](const std::string& id, Priority priority) {
    auto job = new_job(id);
    job.priority = priority;
    lost.jobs().add_job(job, "request");
  };
  for (int i = 0; i < 12; ++i) add("normal" + std::to_string(i), Priority::normal);
  for (int i = 0; i < 2; ++i) add("background" + std::to_string(i), Priority::background);
  wait_milliseconds(100);
  const auto taken = other.leases()->lease_jobs({.foreground = 0, .background = 12});
  const auto in_background = std::count_if(taken.begin(), taken.end(),
                                           [](const JobRecord& job) { return job.priority == Priority::background; });
  EXPECT_EQ(in_background, 2);
  EXPECT_EQ(taken.size(), 10U) << "of the others no more than one call takes for which no worker is idle";
}

TEST_F(SharedStoreTest, DropsTheLargeRequestOfAJobThatIsDismissed) {
  SharedStore store(options());
  const auto job = new_job("job");
  store.jobs().add_job(
      job, store.blobs().store_request(job, {"POST", "/v1/x", {}, "text/plain", "*/*"}, std::string(300'000, 'x')));
  EXPECT_EQ(files_in(in_data("requests")), 1U);
  store.leases()->dismiss_job("job", 5, 6);
  EXPECT_EQ(files_in(in_data("requests")), 0U);
}

TEST_F(SharedStoreTest, NoticesRequestsAndMeshesThatHaveChanged) {
  SharedStore store(options());
  const auto job = new_job("job");
  store.jobs().add_job(
      job, store.blobs().store_request(job, {"POST", "/v1/x", {}, "text/plain", "*/*"}, std::string(300'000, 'x')));
  std::fstream(in_data("requests/job.request")).seekp(-1, std::ios::end) << "y";
  EXPECT_EQ(code_of([&] { store.blobs().job_request("job"); }), "store.corrupted");

  const auto id = store.meshes().add_mesh("mesh", describe).first.id;
  overwrite("meshes/" + id + ".ply", "mash");
  EXPECT_EQ(code_of([&] { store.meshes().mesh_content(id); }), "store.corrupted");
  EXPECT_FALSE(store.meshes().add_mesh("mesh", describe).second);
  EXPECT_EQ(store.meshes().mesh_content(id), "mesh") << "uploading it again repairs it";
}

TEST_F(SharedStoreTest, SaysThatWhatAnotherServerIsRemovingIsNotThere) {
  SharedStore store(options());
  const Result result{"text/plain", {}, "answer"};
  store.jobs().finish_job(ended(running(store, "job")), &result);
  const auto mesh = store.meshes().add_mesh("mesh", describe).first.id;
  // Another server is removing the files, and commits in a moment.
  std::thread other(
      [&] { PrivatePostgres::rows(database_, "DELETE FROM jobs; DELETE FROM meshes; SELECT pg_sleep(1)"); });
  while (PrivatePostgres::rows(database_, "SELECT pid FROM pg_stat_activity WHERE wait_event = $$PgSleep$$").empty())
    wait_milliseconds(10);
  fs::remove_all(in_data("results"));
  fs::remove(in_data("meshes/" + mesh + ".ply"));
  std::vector<std::thread> askers;
  std::array<std::string, 3> codes;
  askers.emplace_back([&] { codes[0] = code_of([&] { store.meshes().mesh_content(mesh); }); });
  askers.emplace_back([&] { codes[1] = code_of([&] { store.meshes().open_mesh_content(mesh); }); });
  askers.emplace_back([&] { codes[2] = code_of([&] { store.blobs().job_result("job"); }); });
  for (auto& asker : askers) asker.join();
  other.join();
  EXPECT_EQ(codes, (std::array<std::string, 3>{"mesh.not_found", "mesh.not_found", "job.not_found"}));
}

TEST_F(SharedStoreTest, LeavesNoFileOfAResultThatTheDatabaseRefuses) {
  SharedStore store(options());
  auto job = ended(running(store, "job"));
  const Result result{"text/plain", {}, "answer"};
  auto refused = job;
  refused.error = "\xff is no text";
  EXPECT_EQ(code_of([&] { store.jobs().finish_job(refused, &result); }), "store.unavailable");
  EXPECT_EQ(files_in(in_data("results")), 0U);
  EXPECT_TRUE(store.jobs().finish_job(job, &result)) << "it goes on afterwards";
  EXPECT_EQ(store.blobs().job_result("job").body.text(), "answer");
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

TEST_F(SharedStoreTest, TellsTheDatabaseOfUsesOnceItIsThereAgain) {
  SharedStore store(options());
  const auto mesh = store.meshes().add_mesh("used", describe).first.id;
  wait_milliseconds(20);
  const auto before = now_milliseconds();
  wait_milliseconds(20);
  store.meshes().note_mesh_use(mesh);
  auto& postgres = PrivatePostgres::of_this_process();
  postgres.kill();
  EXPECT_EQ(code_of([&] { store.leases()->renew_leases({}); }), "store.unavailable");
  postgres.again();
  EXPECT_EQ(store.meshes().remove_unused_meshes(before).size(), 0U);
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

TEST_F(SharedStoreTest, RefusesTablesOfALaterVersion) {
  { const SharedStore store(options()); }
  PrivatePostgres::rows(database_, "UPDATE store SET version = 2");
  EXPECT_EQ(code_of([&] { const SharedStore store(options()); }), "store.unavailable");
}

TEST_F(SharedStoreTest, RefusesAFolderOfAnotherDatabase) {
  { const SharedStore store(options()); }
  auto other = options();
  other.database = PrivatePostgres::of_this_process().new_database();
  EXPECT_EQ(code_of([&] { const SharedStore store(other); }), "store.unavailable");
  auto moved = options();
  moved.folder = folder_ / "elsewhere";
  EXPECT_EQ(code_of([&] { const SharedStore store(moved); }), "store.unavailable");
  EXPECT_EQ(code_of([&] { const SharedStore store(options()); }), "nothing was thrown");
}

TEST_F(SharedStoreTest, RefusesAFolderThatAServerHasAlone) {
  const LocalStore local(folder_ / "data");
  EXPECT_EQ(code_of([&] { const SharedStore store(options()); }), "store.unavailable");
}

TEST_F(SharedStoreTest, IsUnavailableWhileTheDatabaseIsAwayAndGoesOnAfterwards) {
  SharedStore store(options());
  store.jobs().add_job(new_job("job"));
  auto& postgres = PrivatePostgres::of_this_process();
  postgres.kill();
  EXPECT_EQ(code_of([&] { store.jobs().job("job"); }), "store.unavailable");
  EXPECT_EQ(code_of([&] { store.meshes().add_mesh("ply", describe); }), "store.unavailable");
  postgres.again();
  EXPECT_TRUE(store.jobs().job("job").has_value());
  EXPECT_TRUE(store.meshes().add_mesh("ply", describe).second);
  postgres.kill();
  postgres.again();
  EXPECT_TRUE(store.jobs().job("job").has_value()) << "a call after the connection was lost makes it again";
}

TEST_F(SharedStoreTest, GivesUpADatabaseThatHangsAndGoesOnAfterwards) {
  auto impatient = options();
  impatient.transaction_timeout = 0.5;
  SharedStore store(impatient);
  store.jobs().add_job(new_job("job"));
  auto& postgres = PrivatePostgres::of_this_process();
  postgres.freeze();
  const auto start = now_milliseconds();
  std::atomic<int> refused{0};
  std::vector<std::thread> callers;
  for (int i = 0; i < 8; ++i)
    callers.emplace_back([&] { refused += code_of([&] { store.jobs().job("job"); }) == "store.unavailable" ? 1 : 0; });
  for (auto& caller : callers) caller.join();
  const auto time = now_milliseconds() - start;
  postgres.thaw();
  EXPECT_EQ(refused, 8);
  EXPECT_LT(time, 10'000) << "those who waited for their turn do not try one after the other";
  EXPECT_TRUE(store.jobs().job("job").has_value());
}

TEST_F(SharedStoreTest, AsksADatabaseAgainForWhoHasNotWaitedLong) {
  const auto socket = folder_ / "socket";
  const auto real = database_.substr(sizeof "host=" - 1, database_.find(' ') - sizeof "host=" + 1);
  const auto leads_to = [&](const fs::path& folder) {
    fs::remove(socket);
    fs::create_directory_symlink(folder, socket);
  };
  leads_to(real);
  auto through = options();
  through.database.replace(sizeof "host=" - 1, real.size(), socket.string());
  SharedStore store(through);
  store.jobs().add_job(new_job("job"));
  const SilentDatabase silent(folder_ / "silent");
  leads_to(folder_ / "silent");
  PrivatePostgres::rows(database_,
                        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = current_database() AND "
                        "pid <> pg_backend_pid()");
  std::string first;
  std::string second;
  std::thread before([&] { first = code_of([&] { store.jobs().job("job"); }); });
  const int connection = silent.accept();
  leads_to(real);
  std::thread after([&] { second = code_of([&] { store.jobs().job("job"); }); });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  ::close(connection);
  before.join();
  after.join();
  EXPECT_EQ(first, "store.unavailable");
  EXPECT_EQ(second, "nothing was thrown") << "the database is there again, which the other call could not know";
}

TEST_F(SharedStoreTest, SaysThatNoDatabaseAnswers) {
  auto none = options();
  none.database = "host=" + (folder_ / "nothing").string() + " dbname=none";
  EXPECT_EQ(code_of([&] { const SharedStore store(none); }), "store.unavailable");
}

TEST_F(SharedStoreTest, GivesUpADatabaseWhoseMachineTakesConnectionsAndSaysNothing) {
  const SilentDatabase machine;
  auto silent = options();
  silent.database = "postgresql://supple@127.0.0.1:" + std::to_string(machine.port()) + "/supple";
  EXPECT_EQ(code_of([&] { const SharedStore store(silent); }), "store.unavailable") << "and does not wait for ever";
}

TEST_F(SharedStoreTest, KeepsWhatItsConnectionStringSays) {
  auto quoted = options();
  quoted.database += " application_name='Bob\\'s \\\\ store' connect_timeout=7";
  SharedStore store(quoted);
  EXPECT_TRUE(store.meshes().add_mesh("ply", describe).second);
  EXPECT_EQ(PrivatePostgres::rows(database_,
                                  "SELECT application_name FROM pg_stat_activity WHERE datname = "
                                  "current_database() AND pid <> pg_backend_pid()"),
            "Bob's \\ store");
  auto mistaken = options();
  mistaken.database = "host=/tmp nonsense=1";
  try {
    const SharedStore unknown(mistaken);
    FAIL() << "a setting that does not exist";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("nonsense"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace supple::store
