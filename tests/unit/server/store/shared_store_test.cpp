#include "supple/store/shared_store.h"

#include <array>
#include <string>
#include <thread>
#include <vector>

#include "shared_store_fixture.h"
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

TEST_F(SharedStoreTest, AFamilyIsThatOfAllServersAndStaysWhileAJobOfAnyNeedsIt) {
  SharedStore one(options());
  SharedStore two(options());
  const FamilyRecord family{random_id(), "a", "own", now_milliseconds(), "{}", "{}"};
  EXPECT_TRUE(one.families().add_family(family).second);
  EXPECT_FALSE(two.families().add_family(family).second);
  EXPECT_EQ(two.families().family("a", "own")->id, family.id);
  auto job = new_job("job", "a");
  job.families = family.id;
  ASSERT_TRUE(two.jobs().add_job(job, "request"));
  EXPECT_EQ(one.jobs().job("job")->families, family.id);
  EXPECT_EQ(code_of([&] { one.families().remove_family("a", "own"); }), "family.in_use");
  ASSERT_TRUE(two.jobs().finish_job(ended(job), nullptr));
  EXPECT_TRUE(one.families().remove_family("a", "own"));
  EXPECT_TRUE(two.families().families("a").empty());
  auto late = new_job("late", "a");
  late.families = family.id;
  EXPECT_EQ(code_of([&] { two.jobs().add_job(late, "request"); }), "tiling.family_not_found");
}

TEST_F(SharedStoreTest, ADatabaseOfAnEarlierVersionGetsFamilies) {
  { const SharedStore store(options()); }
  PrivatePostgres::rows(database_, "DROP TABLE families");
  PrivatePostgres::rows(database_, "ALTER TABLE jobs DROP COLUMN families");
  SharedStore store(options());
  EXPECT_TRUE(store.families().add_family({random_id(), "", "own", 1, "{}", "{}"}).second);
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

TEST_F(SharedStoreTest, NoticesAResultThatHasChanged) {
  SharedStore store(options());
  const Result result{"text/plain", {}, "answer"};
  store.jobs().finish_job(ended(running(store, "job")), &result);
  const auto file = fs::directory_iterator(folder_ / "data" / "results")->path();
  std::ofstream(file, std::ios::app) << "!";
  EXPECT_EQ(code_of([&] { store.blobs().job_result("job"); }), "store.corrupted");
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

}  // namespace
}  // namespace supple::store
