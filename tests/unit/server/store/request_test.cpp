#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "store_fixture.h"

namespace supple::store {
namespace {

/// Runs each test with a small request, stored in the database and in a file, and with one too large for the database.
class RequestTest : public StoreTest, public ::testing::WithParamInterface<std::size_t> {
 protected:
  const std::string body_ = "{\"body\": 1}" + std::string(1, '\0') + std::string(GetParam(), '\xFF');
};
INSTANTIATE_TEST_SUITE_P(Sizes, RequestTest, ::testing::Values(1000, 300'000));

TEST_P(RequestTest, IsKeptUntilItsJobHasEnded) {
  const JobRequest request{"POST", "/v1/geodesics", {{"a", "1"}, {"b:\n", "x"}}, "application/json", "text/csv"};
  {
    LocalStore store(folder_);
    for (const char* id : {"first", "second", "ended", "removed"}) {
      const auto job = new_job(id);
      store.jobs().add_job(job, store.blobs().store_request(job, request, body_));
    }
    store.blobs().store_request(new_job("never added"), request, body_);
    auto job = *store.jobs().job("second");
    job.state = JobState::running;
    job.started = 5;
    job.attempts = 2;
    store.jobs().update_job(job);
    job = *store.jobs().job("ended");
    job.state = JobState::failed;
    job.finished = 1000;
    store.jobs().finish_job(job, nullptr);
    store.jobs().update_job(new_job("ended"));
    EXPECT_EQ(store.jobs().job("ended")->state, JobState::failed) << "it has finished";
    store.jobs().remove_job("removed");
    EXPECT_FALSE(store.blobs().has_request("ended"));
    EXPECT_FALSE(store.blobs().has_request("removed"));
  }
  const LocalStore store(folder_, recovery());
  EXPECT_FALSE(store.blobs().has_request("never added"));
  const auto unfinished = store.jobs().unfinished_jobs();
  ASSERT_EQ(unfinished.size(), 2U);
  EXPECT_EQ(unfinished[0].id, "first");
  EXPECT_EQ(unfinished[1].id, "second");
  EXPECT_EQ(unfinished[1].state, JobState::running);
  EXPECT_EQ(unfinished[1].attempts, 2);
  const auto kept = store.blobs().job_request("first");
  EXPECT_EQ(kept.body, body_);
  EXPECT_EQ(kept.request.method, "POST");
  EXPECT_EQ(kept.request.path, "/v1/geodesics");
  EXPECT_EQ(kept.request.query, request.query);
  EXPECT_EQ(kept.request.content_type, "application/json");
  EXPECT_EQ(kept.request.accept, "text/csv");
  std::ofstream(folder_ / "requests" / "first.request", std::ios::app) << " ";
  if (GetParam() > 256 << 10) {
    EXPECT_EQ(code_of([&] { store.blobs().job_request("first"); }), "store.corrupted");
  } else {
    EXPECT_EQ(store.blobs().job_request("first").body, body_) << "the database has it";
  }
}

TEST_P(RequestTest, OutlivesTheDatabaseWhetherTheProcessEndsOrIsKilled) {
  const pid_t child = fork();
  if (child == 0) {
    LocalStore store(folder_);
    for (const char* id : {"b", "a"}) {
      auto job = new_job(id);
      job.created = id[0] == 'b' ? 1000 : 2000;
      store.jobs().add_job(job, store.blobs().store_request(job, {"POST", "/x", {{"a", "1"}}, {}, {}}, body_));
    }
    ::kill(::getpid(), SIGKILL);
  }
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  for (const char* rest : {"supple.sqlite-wal", "supple.sqlite-shm"})
    fs::remove(folder_ / rest);  // with these, SQLite would repair the database
  std::ofstream(folder_ / "supple.sqlite") << std::string(10'000, '?');
  for (const char* when : {"damaged", "lost"}) {
    {
      const LocalStore store(folder_, recovery());
      const auto unfinished = store.jobs().unfinished_jobs();
      ASSERT_EQ(unfinished.size(), 2U) << when;
      EXPECT_EQ(unfinished[0].id, "b") << "the oldest first";
      EXPECT_EQ(store.blobs().job_request("a").body, body_);
      EXPECT_EQ(store.blobs().job_request("a").request.query.at("a"), "1");
      EXPECT_EQ(quarantined().size(), 1U) << when << ": the damaged database alone";
    }
    fs::remove(folder_ / "supple.sqlite");
  }
}

TEST_P(RequestTest, HasNoFileOnceItsJobHasEndedOrWasNotAdded) {
  LocalStore store(folder_);
  auto job = new_job("ended");
  store.jobs().add_job(job, store.blobs().store_request(job, {"POST", "/x", {}, {}, {}}, body_));
  store.blobs().store_request(new_job("not added"), {"POST", "/x", {}, {}, {}}, body_);
  store.blobs().remove_request("not added");
  job.state = JobState::failed;
  job.finished = 1000;
  store.jobs().finish_job(job, nullptr);
  EXPECT_TRUE(fs::is_empty(folder_ / "requests"));
  EXPECT_EQ(store.usage().requests, 0);
}

TEST_F(StoreTest, WritesSpareFilesOfRequestsAgainThatAreMissingOrCutOff) {
  const std::string body = "{}";
  const auto file = [&](const std::string& id) { return folder_ / "requests" / (id + ".request"); };
  {
    LocalStore store(folder_);
    for (const char* id : {"missing", "cut off"}) {
      const auto job = new_job(id);
      store.jobs().add_job(job, store.blobs().store_request(job, {"POST", "/x", {}, {}, {}}, body));
    }
  }
  fs::remove(file("missing"));
  fs::resize_file(file("cut off"), 20);
  { const LocalStore store(folder_, recovery()); }
  EXPECT_TRUE(warnings_.empty());
  fs::remove(folder_ / "supple.sqlite");
  const LocalStore store(folder_, recovery());
  for (const char* id : {"missing", "cut off"}) EXPECT_EQ(store.blobs().job_request(id).body, body) << id;
}

TEST_F(StoreTest, KnowsAJobByItsKeyOfIdempotencyAlsoWithoutTheDatabase) {
  auto job = new_job("first");
  job.idempotency_key = "key";
  job.request_hash = "hash";
  {
    LocalStore store(folder_);
    EXPECT_TRUE(store.jobs().add_job(job, store.blobs().store_request(job, {"POST", "/x", {}, {}, {}}, "body")));
    auto again = job;
    again.id = "second";
    EXPECT_FALSE(store.jobs().add_job(again));
    EXPECT_FALSE(store.jobs().job("second").has_value());
    EXPECT_FALSE(store.jobs().job_of_key("").has_value()) << "jobs without a key are not one job";
    EXPECT_FALSE(store.jobs().job_of_key("another").has_value());
  }
  {
    const LocalStore store(folder_);
    EXPECT_EQ(store.jobs().job_of_key("key")->id, "first");
    EXPECT_EQ(store.jobs().job_of_key("key")->request_hash, "hash");
  }
  fs::remove(folder_ / "supple.sqlite");
  LocalStore store(folder_, recovery());
  EXPECT_EQ(store.jobs().job_of_key("key")->id, "first");
  EXPECT_EQ(store.jobs().job_of_key("key")->request_hash, "hash");
  EXPECT_TRUE(store.jobs().remove_job("first"));
  EXPECT_TRUE(store.jobs().add_job(job)) << "it is forgotten with the job";
}

}  // namespace
}  // namespace supple::store
