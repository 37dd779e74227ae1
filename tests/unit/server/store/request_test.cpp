#include "store_fixture.h"

namespace supple::store {
namespace {

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

}  // namespace
}  // namespace supple::store
