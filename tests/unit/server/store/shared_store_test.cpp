#include "supple/store/shared_store.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <thread>

#include "store_fixture.h"
#include "supple/store/local_store.h"
#include "support/private_postgres.h"

namespace supple::store {
namespace {

using testing::PrivatePostgres;

/// A port whose connections the system takes and nobody answers.
class SilentPort {
 public:
  SilentPort() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(socket_, 8), 0);
    EXPECT_EQ(::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    number_ = ntohs(address.sin_port);
  }
  ~SilentPort() { ::close(socket_); }
  SilentPort(const SilentPort&) = delete;
  SilentPort& operator=(const SilentPort&) = delete;

  int number() const { return number_; }

 private:
  const int socket_;
  int number_ = 0;
};

/// Two servers of one database and one folder.
class SharedStoreTest : public StoreTest {
 protected:
  SharedStore::Options options(double lease = 60) {
    SharedStore::Options options;
    options.database = database_;
    options.folder = folder_ / "data";
    options.lease = lease;
    options.quota = quota_;
    options.warn = [this](const std::string& text) { warnings_.push_back(text); };
    return options;
  }
  /// A job that the server has and runs.
  static JobRecord running(SharedStore& server, const std::string& id) {
    auto job = new_job(id);
    server.add_job(job, "request");
    job.state = JobState::running;
    job.started = now_milliseconds();
    job.attempts = 1;
    EXPECT_TRUE(server.note_progress(job));
    return job;
  }
  static JobRecord ended(JobRecord job) {
    job.state = JobState::successful;
    job.finished = now_milliseconds();
    job.expires = job.finished + 60'000;
    return job;
  }
  static std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
  }

  const std::string database_ = PrivatePostgres::of_this_process().new_database();
  Quota quota_;
  std::vector<std::string> warnings_;
};

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
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
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
    const auto stored = two.job_request(id);
    EXPECT_EQ(stored.body, body);
    EXPECT_EQ(stored.request.query, request.query);
    const auto seen = two.job(id);
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->owner, "alice");
    EXPECT_EQ(seen->client, "client");
    EXPECT_EQ(seen->session, "session");
    EXPECT_EQ(seen->deadline, job.deadline);

    const Result result{"text/plain", {{"ETag", "\"1\""}}, "answer"};
    EXPECT_TRUE(one.finish_job(ended(job), &result));
    const Result again{"text/plain", {}, "something else"};
    EXPECT_FALSE(one.finish_job(ended(job), &again)) << "it has ended";
    const auto found = two.job_result(id);
    EXPECT_EQ(found.body.text(), "answer");
    EXPECT_EQ(found.headers, result.headers);
    EXPECT_FALSE(two.has_request(id));
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
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto taken = other.take_jobs(0);
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].id, "job");
  EXPECT_EQ(taken[0].state, JobState::running);
  EXPECT_EQ(taken[0].attempts, 1);
  EXPECT_EQ(taken[0].hold, job.hold + 1);
  EXPECT_EQ(other.take_jobs(5).size(), 0U) << "it has them already";

  // The lost one goes on without knowing it: nothing of what it says counts.
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
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
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
    source.note_progress(job);  // it waits: nobody has it
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
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const auto before = now_milliseconds();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  store.use_mesh(used);
  EXPECT_EQ(store.remove_unused_meshes(before), std::vector<std::string>{unused});
  EXPECT_EQ(store.mesh_content(used), "used");
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

TEST_F(SharedStoreTest, SaysThatNoDatabaseAnswers) {
  auto none = options();
  none.database = "host=" + (folder_ / "nothing").string() + " dbname=none";
  EXPECT_EQ(code_of([&] { const SharedStore store(none); }), "store.unavailable");
}

TEST_F(SharedStoreTest, GivesUpADatabaseWhoseMachineTakesConnectionsAndSaysNothing) {
  const SilentPort port;
  auto silent = options();
  silent.database = "postgresql://supple@127.0.0.1:" + std::to_string(port.number()) + "/supple";
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
