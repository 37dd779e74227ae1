#include "supple/store/shared_store.h"

#include <unistd.h>

#include <array>
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
  const auto added = one.add_mesh("ply", describe, "alice");
  const auto& record = added.first;
  EXPECT_TRUE(added.second);
  EXPECT_EQ(two.mesh_content(record.id), "ply");
  EXPECT_FALSE(two.add_mesh("ply", describe, "alice").second) << "uploading twice is one mesh";
  EXPECT_TRUE(two.add_mesh("ply", describe, "bob").second);
  EXPECT_TRUE(one.owns_mesh(record.id, "bob"));
  EXPECT_EQ(one.meshes(10, {}, "carol").size(), 0U);
  EXPECT_EQ(one.meshes(10, {}, "bob").size(), 1U);
  EXPECT_FALSE(one.is_last_owner_of_mesh(record.id, "bob"));

  EXPECT_TRUE(one.still_has_mesh(record.id));
  EXPECT_TRUE(two.remove_mesh(record.id, "alice"));
  EXPECT_FALSE(two.remove_mesh(record.id, "alice"));
  EXPECT_TRUE(one.is_last_owner_of_mesh(record.id, "bob"));
  EXPECT_TRUE(one.mesh(record.id).has_value());
  EXPECT_TRUE(two.remove_mesh(record.id, "bob"));
  EXPECT_FALSE(one.mesh(record.id).has_value());
  EXPECT_EQ(files_in(folder_ / "data" / "meshes"), 0U);
  EXPECT_EQ(code_of([&] { one.mesh_content(record.id); }), "mesh.not_found");
  wait_milliseconds(1100);
  EXPECT_FALSE(one.still_has_mesh(record.id)) << "within a second";
}

TEST_F(SharedStoreTest, PagesThroughMeshesAndJobsFromTheNewest) {
  SharedStore store(options());
  std::vector<std::string> ids;
  for (const char* ply : {"a", "b", "c"}) ids.push_back(store.add_mesh(ply, describe).first.id);
  const auto first = store.meshes(2, {});
  ASSERT_EQ(first.size(), 2U);
  EXPECT_EQ(first[0].id, ids[2]);
  EXPECT_EQ(store.meshes(2, first[1].id).at(0).id, ids[0]);

  store.add_job(new_job("one", "alice"));
  store.add_job(new_job("two"));
  EXPECT_EQ(store.jobs({}, 10, {}).at(0).id, "two");
  EXPECT_EQ(store.jobs({}, 10, "two").at(0).id, "one");
  EXPECT_EQ(store.jobs({JobState::running}, 10, {}).size(), 0U);
  EXPECT_EQ(store.jobs({JobState::accepted}, 10, {}, "alice").size(), 1U);
  EXPECT_TRUE(store.owns_job("one", "alice"));
  EXPECT_FALSE(store.owns_job("two", "alice"));
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
    const JobRequest request{"POST", "/v1/x", {{"a", "b=c"}}, "text/plain", "*/*"};
    EXPECT_TRUE(one.add_job(job, one.keep_request(job, request, body)));
    EXPECT_TRUE(two.has_request(id));
    EXPECT_EQ(files_in(folder_ / "data" / "requests"), size > 100'000 ? 1U : 0U) << "small ones are in the database";
    const auto stored = two.job_request(id);
    EXPECT_EQ(stored.body, body);
    EXPECT_EQ(stored.request.query, request.query);
    const auto seen = two.job(id);
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->owner, "alice");
    EXPECT_EQ(seen->client, "client");
    EXPECT_EQ(seen->session, "session");
    EXPECT_EQ(seen->deadline, job.deadline);

    EXPECT_FALSE(two.remove_job(id)) << "it has not ended";
    const auto revision = two.job_progress(id)->revision;
    const Result result{"text/plain", {{"ETag", "\"1\""}}, "answer"};
    EXPECT_TRUE(one.finish_job(ended(job), &result));
    const Result again{"text/plain", {}, "something else"};
    EXPECT_FALSE(one.finish_job(ended(job), &again)) << "it has ended";
    const auto found = two.job_result(id);
    EXPECT_EQ(found.body.text(), "answer");
    EXPECT_EQ(found.headers, result.headers);
    EXPECT_FALSE(two.has_request(id));
    EXPECT_GT(two.job_progress(id)->revision, revision) << "who waits for it is told";
    overwrite("requests/" + id + ".request", "left by a server that was lost in that moment");
    EXPECT_EQ(two.job(id)->state, JobState::successful);
    EXPECT_TRUE(two.remove_job(id));
    EXPECT_FALSE(one.remove_job(id));
    EXPECT_EQ(code_of([&] { one.job_result(id); }), "job.not_found");
  }
  EXPECT_EQ(files_in(folder_ / "data" / "results"), 0U);
  EXPECT_EQ(files_in(folder_ / "data" / "requests"), 0U);
}

TEST_F(SharedStoreTest, TakesTheJobsOfAServerThatIsNotHeardOf) {
  SharedStore lost(options(0.05));
  SharedStore other(options());
  auto job = running(lost, "job");
  wait_milliseconds(100);
  const auto taken = other.take_jobs(0);
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].id, "job");
  EXPECT_EQ(taken[0].state, JobState::running);
  EXPECT_EQ(taken[0].attempts, 1);
  EXPECT_EQ(taken[0].hold, job.hold + 1);
  EXPECT_EQ(other.take_jobs(5).size(), 0U) << "it has them already";

  // The lost server goes on without knowing that it was lost: its reports are refused.
  const Result late{"text/plain", {}, "late"};
  EXPECT_FALSE(lost.note_progress(job));
  EXPECT_FALSE(lost.finish_job(ended(job), &late));
  EXPECT_EQ(lost.keep_holds({}).size(), 0U);
  EXPECT_EQ(other.job("job")->finished, 0);
  const Result right{"text/plain", {}, "right"};
  EXPECT_TRUE(other.finish_job(ended(taken[0]), &right));
  EXPECT_FALSE(lost.finish_job(ended(job), &late));
  EXPECT_EQ(lost.job_result("job").body.text(), "right");
  EXPECT_EQ(files_in(folder_ / "data" / "results"), 1U) << "the late one has left no file";
}

TEST_F(SharedStoreTest, RemovesTheFileOfAServerThatWasLostBeforeItsRow) {
  SharedStore lost(options(0.05));
  SharedStore other(options());
  running(lost, "job");
  std::ofstream(folder_ / "data" / "results" / "job.0.result") << "its row is missing";
  wait_milliseconds(100);
  const auto taken = other.take_jobs(0);
  ASSERT_EQ(taken.size(), 1U);
  const Result result{"text/plain", {}, "right"};
  EXPECT_TRUE(other.finish_job(ended(taken[0]), &result));
  EXPECT_EQ(files_in(folder_ / "data" / "results"), 1U);
  EXPECT_EQ(other.job_result("job").body.text(), "right");
}

TEST_F(SharedStoreTest, LeavesJobsToAServerThatIsHeardOf) {
  SharedStore one(options());
  SharedStore two(options());
  running(one, "runs");
  one.add_job(new_job("waits"), "request");
  EXPECT_EQ(two.take_jobs(0).size(), 0U) << "it has no time for them";
  const auto taken = two.take_jobs(5);
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].id, "waits");
  EXPECT_EQ(two.take_jobs(5).size(), 0U) << "its own are not taken again, though they have not begun";
  const auto held = one.keep_holds({});
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
    source.add_job(job, "request");
    source.note_progress(job);  // the job waits, and no server has it
  }
  std::atomic<int> taken{0};
  const auto take = [&](SharedStore& server) {
    for (int i = 0; i < jobs; ++i) taken += static_cast<int>(server.take_jobs(0).size());
  };
  std::thread first([&] { take(one); });
  take(two);
  first.join();
  EXPECT_EQ(taken, jobs);
  EXPECT_EQ(one.keep_holds({}).size() + two.keep_holds({}).size(), static_cast<std::size_t>(jobs));
}

TEST_F(SharedStoreTest, FreesItsJobsAtItsEnd) {
  SharedStore other(options());
  {
    SharedStore ends(options());
    ends.add_job(new_job("waits"), "request");
    auto job = running(ends, "put back");
    job.state = JobState::accepted;
    EXPECT_TRUE(ends.note_progress(job));
    EXPECT_EQ(other.take_jobs(0).size(), 1U) << "one that is put back is free at once";
  }
  EXPECT_EQ(other.take_jobs(0).size(), 1U);
}

TEST_F(SharedStoreTest, TellsOtherServersHowFarAJobIs) {
  SharedStore one(options());
  SharedStore two(options());
  running(one, "job");
  const auto before = two.job_progress("job");
  one.keep_holds({{"job", 0.25, "solving", "{\"a\":1}"}});
  const auto after = two.job_progress("job");
  ASSERT_TRUE(before && after);
  EXPECT_EQ(after->fraction, 0.25);
  EXPECT_EQ(after->stage, "solving");
  EXPECT_EQ(after->partial, "{\"a\":1}");
  EXPECT_GT(after->revision, before->revision);
  two.keep_holds({{"job", 0.5, "of another", ""}});
  EXPECT_EQ(one.job_progress("job")->fraction, 0.25) << "only who holds it tells how far it is";
}

TEST_F(SharedStoreTest, DismissesAJobOfAnotherServer) {
  SharedStore one(options());
  SharedStore two(options());
  const auto job = running(one, "job");
  const auto dismissed = two.dismiss_job("job", 5, 6);
  ASSERT_TRUE(dismissed);
  EXPECT_EQ(dismissed->state, JobState::dismissed);
  EXPECT_EQ(dismissed->expires, 6);
  EXPECT_GT(dismissed->hold, job.hold) << "a file that its server still writes is not its result";
  EXPECT_FALSE(two.dismiss_job("job", 5, 6)) << "it has ended";
  EXPECT_EQ(one.keep_holds({}).size(), 0U);
  const Result late{"text/plain", {}, "late"};
  EXPECT_FALSE(one.finish_job(ended(job), &late));
  EXPECT_EQ(two.job("job")->state, JobState::dismissed);
}

TEST_F(SharedStoreTest, KnowsAJobByItsKeyOfIdempotency) {
  SharedStore one(options());
  SharedStore two(options());
  auto job = new_job("first");
  job.idempotency_key = "key";
  job.request_hash = "hash";
  EXPECT_TRUE(one.add_job(job));
  EXPECT_EQ(two.job_of_key("key")->id, "first");
  EXPECT_EQ(two.job_of_key("key")->request_hash, "hash");
  job.id = "second";
  EXPECT_FALSE(two.add_job(job));
  EXPECT_FALSE(two.job("second").has_value());
  EXPECT_FALSE(two.job_of_key("").has_value()) << "jobs without a key are not one job";
}

TEST_F(SharedStoreTest, RemovesWhatHasExpiredAndWhatNobodyUses) {
  SharedStore store(options());
  const Result result{"text/plain", {}, "answer"};
  for (const char* id : {"old", "older", "new"}) {
    auto job = ended(running(store, id));
    if (std::string(id) == "old") job.expires = 10;
    store.finish_job(job, &result);
  }
  running(store, "unfinished");
  EXPECT_EQ(store.remove_expired_jobs(11, 100), 1U);
  EXPECT_FALSE(store.job("old").has_value());
  EXPECT_EQ(store.remove_expired_jobs(11, 1), 1U) << "beyond the most that are kept";
  EXPECT_TRUE(store.job("new").has_value());
  EXPECT_TRUE(store.job("unfinished").has_value());
  EXPECT_EQ(files_in(folder_ / "data" / "results"), 1U);

  const auto used = store.add_mesh("used", describe).first.id;
  const auto unused = store.add_mesh("unused", describe).first.id;
  const auto busy = store.add_mesh("busy", describe).first.id;
  auto job = new_job("works on it");
  job.mesh = busy;
  store.add_job(job);
  EXPECT_TRUE(store.has_unfinished_job_on(busy));
  EXPECT_FALSE(store.has_unfinished_job_on(used));
  wait_milliseconds(20);
  const auto before = now_milliseconds();
  wait_milliseconds(20);
  store.use_mesh(used);
  EXPECT_EQ(store.remove_unused_meshes(before), std::vector<std::string>{unused});
  EXPECT_EQ(store.mesh_content(used), "used");
  EXPECT_EQ(files_in(folder_ / "data" / "meshes"), 2U);
  store.finish_job(ended(job), nullptr);
  EXPECT_FALSE(store.has_unfinished_job_on(busy));
}

TEST_F(SharedStoreTest, ExpiresTheOldestResultsForWhatIsNewAndRefusesWhatDoesNotFit) {
  {
    const SharedStore empty(options());
    quota_.bytes = empty.usage().database + (1 << 20);
  }
  SharedStore store(options());
  const Result large{"text/plain", {}, std::string(600'000, 'x')};
  EXPECT_TRUE(store.finish_job(ended(running(store, "first")), &large));
  EXPECT_TRUE(store.finish_job(ended(running(store, "second")), &large));
  EXPECT_FALSE(store.job("first").has_value());
  EXPECT_TRUE(store.job("second").has_value());
  EXPECT_EQ(warnings_.size(), 1U);
  EXPECT_EQ(code_of([&] { store.add_mesh(std::string(2'000'000, 'm'), describe); }), "store.quota");
  EXPECT_TRUE(store.job("second").has_value()) << "no result goes for what would not fit without it either";
}

TEST_F(SharedStoreTest, HoldsOwnersToTheirShare) {
  quota_.of_owner = [](const std::string& owner) { return owner == "alice" ? 1000 : 0; };
  SharedStore store(options());
  EXPECT_EQ(code_of([&] { store.add_mesh(std::string(1001, 'm'), describe, "alice"); }), "store.key_quota");
  EXPECT_TRUE(store.add_mesh(std::string(1001, 'm'), describe, "bob").second);
  EXPECT_EQ(code_of([&] { store.add_mesh(std::string(1001, 'm'), describe, "alice"); }), "store.key_quota");
}

TEST_F(SharedStoreTest, NoticesAResultThatHasChanged) {
  SharedStore store(options());
  const Result result{"text/plain", {}, "answer"};
  store.finish_job(ended(running(store, "job")), &result);
  const auto file = fs::directory_iterator(folder_ / "data" / "results")->path();
  std::ofstream(file, std::ios::app) << "!";
  EXPECT_EQ(code_of([&] { store.job_result("job"); }), "store.corrupted");
}

TEST_F(SharedStoreTest, ForgetsTheFormerHoldOfAJobThatAServerLostAndTookAgain) {
  SharedStore one(options());
  SharedStore two(options());
  const auto former = running(one, "job");
  const auto put_back = [](SharedStore& server, JobRecord job) {
    job.state = JobState::accepted;
    EXPECT_TRUE(server.note_progress(job));
  };
  put_back(one, former);
  put_back(two, two.take_jobs(1).at(0));
  const auto present = one.take_jobs(1).at(0);
  EXPECT_FALSE(one.note_progress(former));
  const Result result{"text/plain", {}, "answer"};
  EXPECT_FALSE(one.finish_job(ended(former), &result));
  EXPECT_TRUE(one.finish_job(ended(present), &result));
}

TEST_F(SharedStoreTest, TakesNoNewJobsBesideThoseOfALostServerBeyondItsTime) {
  SharedStore waiting(options());
  SharedStore lost(options(0.05));
  SharedStore other(options());
  for (const char* id : {"a", "b", "c"}) running(lost, id);
  waiting.add_job(new_job("waits"), "request");
  wait_milliseconds(100);
  EXPECT_EQ(other.take_jobs(1).size(), 3U);
  EXPECT_EQ(other.take_jobs(1).at(0).id, "waits");
}

TEST_F(SharedStoreTest, DropsTheLargeRequestOfAJobThatIsDismissed) {
  SharedStore store(options());
  const auto job = new_job("job");
  store.add_job(job, store.keep_request(job, {"POST", "/v1/x", {}, "text/plain", "*/*"}, std::string(300'000, 'x')));
  EXPECT_EQ(files_in(in_data("requests")), 1U);
  store.dismiss_job("job", 5, 6);
  EXPECT_EQ(files_in(in_data("requests")), 0U);
}

TEST_F(SharedStoreTest, NoticesRequestsAndMeshesThatHaveChanged) {
  SharedStore store(options());
  const auto job = new_job("job");
  store.add_job(job, store.keep_request(job, {"POST", "/v1/x", {}, "text/plain", "*/*"}, std::string(300'000, 'x')));
  std::fstream(in_data("requests/job.request")).seekp(-1, std::ios::end) << "y";
  EXPECT_EQ(code_of([&] { store.job_request("job"); }), "store.corrupted");

  const auto id = store.add_mesh("mesh", describe).first.id;
  overwrite("meshes/" + id + ".ply", "mash");
  EXPECT_EQ(code_of([&] { store.mesh_content(id); }), "store.corrupted");
  EXPECT_FALSE(store.add_mesh("mesh", describe).second);
  EXPECT_EQ(store.mesh_content(id), "mesh") << "uploading it again repairs it";
}

TEST_F(SharedStoreTest, SaysThatWhatAnotherServerIsRemovingIsNotThere) {
  SharedStore store(options());
  const Result result{"text/plain", {}, "answer"};
  store.finish_job(ended(running(store, "job")), &result);
  const auto mesh = store.add_mesh("mesh", describe).first.id;
  // Another server is removing the files, and commits in a moment.
  std::thread other(
      [&] { PrivatePostgres::rows(database_, "DELETE FROM jobs; DELETE FROM meshes; SELECT pg_sleep(1)"); });
  while (PrivatePostgres::rows(database_, "SELECT pid FROM pg_stat_activity WHERE wait_event = $$PgSleep$$").empty())
    wait_milliseconds(10);
  fs::remove_all(in_data("results"));
  fs::remove(in_data("meshes/" + mesh + ".ply"));
  std::vector<std::thread> askers;
  std::array<std::string, 3> codes;
  askers.emplace_back([&] { codes[0] = code_of([&] { store.mesh_content(mesh); }); });
  askers.emplace_back([&] { codes[1] = code_of([&] { store.open_mesh_content(mesh); }); });
  askers.emplace_back([&] { codes[2] = code_of([&] { store.job_result("job"); }); });
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
  EXPECT_EQ(code_of([&] { store.finish_job(refused, &result); }), "store.unavailable");
  EXPECT_EQ(files_in(in_data("results")), 0U);
  EXPECT_TRUE(store.finish_job(job, &result)) << "it goes on afterwards";
  EXPECT_EQ(store.job_result("job").body.text(), "answer");
}

TEST_F(SharedStoreTest, CountsWhatItHolds) {
  SharedStore store(options());
  const auto large_request = [&](const std::string& id) {
    const auto job = new_job(id);
    store.add_job(job, store.keep_request(job, {"POST", "/v1/x", {}, "text/plain", "*/*"}, std::string(300'000, 'x')));
    return job;
  };
  const auto id = store.add_mesh("four", describe, "alice").first.id;
  store.add_mesh("four", describe, "bob");
  const auto job = large_request("job");
  const auto small = new_job("small");  // its request is in the database
  store.add_job(small, store.keep_request(small, {"POST", "/v1/x", {}, "text/plain", "*/*"}, "x"));
  const Result result{"text/plain", {}, std::string(1000, 'x')};
  store.finish_job(ended(running(store, "other")), &result);
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
  store.remove_mesh(id, "alice");
  EXPECT_EQ(store.usage().meshes, 4);
  store.remove_mesh(id, "bob");
  store.remove_job("other");
  EXPECT_EQ(store.usage().results, 0);
  EXPECT_EQ(store.usage().meshes, 0);
  expect_counted();
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
  EXPECT_TRUE(one.finish_job(ended(running(one, "kept")), &large));
  EXPECT_TRUE(one.finish_job(ended(running(one, "removed")), &large));
  const auto mesh = one.add_mesh(std::string(600, 'm'), describe).first.id;
  EXPECT_TRUE(two.remove_job("removed"));
  EXPECT_TRUE(two.remove_mesh(mesh));
  EXPECT_TRUE(one.add_mesh(std::string(700, 'n'), describe).second);
  EXPECT_TRUE(one.finish_job(ended(running(one, "new")), &large));
  EXPECT_TRUE(one.job("kept").has_value());
}

TEST_F(SharedStoreTest, ExpiresTheResultsOfAnOwnerForWhatIsNewOfIt) {
  quota_.of_owner = [](const std::string& owner) { return owner == "alice" ? 3000 : 0; };
  SharedStore store(options());
  const Result result{"text/plain", {}, std::string(1200, 'x')};
  const auto finish = [&](const std::string& id, const std::string& owner) {
    auto job = new_job(id, owner);
    // The request of the job is removed at its end, which makes room for the result.
    store.add_job(job, store.keep_request(job, {"POST", "/v1/x", {}, "text/plain", "*/*"}, std::string(1200, 'r')));
    return store.finish_job(ended(job), &result);
  };
  EXPECT_TRUE(finish("of bob", "bob"));
  EXPECT_TRUE(finish("first", "alice"));
  EXPECT_TRUE(store.job("first").has_value()) << "a result and a request fit";
  EXPECT_TRUE(finish("second", "alice"));
  EXPECT_FALSE(store.job("first").has_value());
  EXPECT_TRUE(store.job("second").has_value());
  EXPECT_TRUE(store.job("of bob").has_value()) << "it is older, and another's";
  EXPECT_EQ(code_of([&] { store.add_mesh(std::string(3001, 'm'), describe, "alice"); }), "store.key_quota");
  EXPECT_TRUE(store.job("second").has_value()) << "no result goes for what would not fit without it either";
}

TEST_F(SharedStoreTest, TellsTheDatabaseOfUsesOnceItIsThereAgain) {
  SharedStore store(options());
  const auto mesh = store.add_mesh("used", describe).first.id;
  wait_milliseconds(20);
  const auto before = now_milliseconds();
  wait_milliseconds(20);
  store.use_mesh(mesh);
  auto& postgres = PrivatePostgres::of_this_process();
  postgres.kill();
  EXPECT_EQ(code_of([&] { store.keep_holds({}); }), "store.unavailable");
  postgres.again();
  EXPECT_EQ(store.remove_unused_meshes(before).size(), 0U);
}

TEST_F(SharedStoreTest, CountsAnewWhatOthersHaveAdded) {
  recount_interval_ = 0.5;
  SharedStore one(options());
  SharedStore two(options());
  two.add_mesh("mesh", describe);
  one.keep_holds({});
  EXPECT_EQ(one.usage().meshes, 0) << "it counted when it was made";
  wait_milliseconds(600);
  one.keep_holds({});
  EXPECT_EQ(one.usage().meshes, 4);
}

TEST_F(SharedStoreTest, MovesWhatNobodyKnowsIntoQuarantine) {
  orphan_age_ = 1;
  SharedStore store(options());
  const Result result{"text/plain", {}, "answer"};
  store.finish_job(ended(running(store, "ended")), &result);
  const auto mesh = store.add_mesh("mesh", describe).first.id;
  const auto job = new_job("waits");
  store.add_job(job, store.keep_request(job, {"POST", "/v1/x", {}, "text/plain", "*/*"}, std::string(300'000, 'x')));
  overwrite("meshes/unknown.ply", "a mesh");
  overwrite("meshes/" + mesh + ".txt", "no mesh");
  overwrite("results/ended.7.result", "of another hold");
  overwrite("requests/ended.request", "of a job that has ended");
  overwrite("results/lost.0.result.0.part", "half-written by a server that was lost");
  wait_milliseconds(1100);
  overwrite("results/young.0.result", "about to be known");
  overwrite("results/young.1.result.0.part", "being written");
  store.remove_expired_jobs(0, 100);
  EXPECT_FALSE(fs::exists(in_data("results/lost.0.result.0.part")));
  EXPECT_TRUE(fs::exists(in_data("results/young.1.result.0.part")));
  EXPECT_EQ(quarantined_in(in_data("quarantine")),
            (std::multiset<std::string>{"a mesh", "no mesh", "of another hold", "of a job that has ended"}));
  EXPECT_EQ(store.mesh_content(mesh), "mesh");
  EXPECT_EQ(store.job_result("ended").body.text(), "answer");
  EXPECT_EQ(store.job_request("waits").body.size(), 300'000U);
  EXPECT_TRUE(fs::exists(in_data("results/young.0.result")));
  fs::last_write_time(in_data("results/young.0.result"), fs::file_time_type::clock::now() - std::chrono::hours(1));
  store.remove_expired_jobs(0, 100);
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
  store.add_job(new_job("job"));
  auto& postgres = PrivatePostgres::of_this_process();
  postgres.kill();
  EXPECT_EQ(code_of([&] { store.job("job"); }), "store.unavailable");
  EXPECT_EQ(code_of([&] { store.add_mesh("ply", describe); }), "store.unavailable");
  postgres.again();
  EXPECT_TRUE(store.job("job").has_value());
  EXPECT_TRUE(store.add_mesh("ply", describe).second);
  postgres.kill();
  postgres.again();
  EXPECT_TRUE(store.job("job").has_value()) << "a call after the connection was lost makes it again";
}

TEST_F(SharedStoreTest, GivesUpADatabaseThatHangsAndGoesOnAfterwards) {
  auto impatient = options();
  impatient.transaction_timeout = 0.5;
  SharedStore store(impatient);
  store.add_job(new_job("job"));
  auto& postgres = PrivatePostgres::of_this_process();
  postgres.freeze();
  const auto start = now_milliseconds();
  std::atomic<int> refused{0};
  std::vector<std::thread> callers;
  for (int i = 0; i < 8; ++i)
    callers.emplace_back([&] { refused += code_of([&] { store.job("job"); }) == "store.unavailable" ? 1 : 0; });
  for (auto& caller : callers) caller.join();
  const auto time = now_milliseconds() - start;
  postgres.thaw();
  EXPECT_EQ(refused, 8);
  EXPECT_LT(time, 10'000) << "those who waited for their turn do not try one after the other";
  EXPECT_TRUE(store.job("job").has_value());
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
  store.add_job(new_job("job"));
  const SilentDatabase silent(folder_ / "silent");
  leads_to(folder_ / "silent");
  PrivatePostgres::rows(database_,
                        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = current_database() AND "
                        "pid <> pg_backend_pid()");
  std::string first;
  std::string second;
  std::thread before([&] { first = code_of([&] { store.job("job"); }); });
  const int connection = silent.accept();
  leads_to(real);
  std::thread after([&] { second = code_of([&] { store.job("job"); }); });
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
  EXPECT_TRUE(store.add_mesh("ply", describe).second);
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
