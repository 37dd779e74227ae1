#include "endpoint.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "immediate_answer.h"
#include "results.h"
#include "supple/json/answers.h"
#include "supple/routes/resume.h"
#include "supple/store/local_store.h"
#include "support/expect_error.h"
#include "support/temporary_folder.h"
#include "unit/server/thrown_problem.h"

namespace supple::routes {
namespace {

namespace fs = std::filesystem;

/// A router whose endpoint /v1/echoes answers with the format that was negotiated and the length of its body.
class EndpointTest : public ::testing::Test {
 protected:
  EndpointTest() {
    store_ = std::make_unique<store::LocalStore>(folder_);
    jobs::QueueOptions queue;
    queue.workers = 1;
    queue.immediate = 1;
    jobs_ = std::make_unique<jobs::JobQueue>(*store_, queue, json::write_problem, [](const store::JobRecord&) {});
    services_.jobs = jobs_.get();
    services_.store = store_.get();
    services_.metrics = &metrics_;
    services_.ready = true;
    add_endpoint(
        router_, services_,
        {.path = "/v1/echoes",
         .kind = "echoes",
         .sends = "An echo is sent as",
         .formats = {"application/json", "text/csv", "text/plain"},
         .prepare = [this](const EndpointRequest& asked, const Loader& loader) { return prepare(asked, loader); }});
    router_.add({"POST", "/v1/others", [](const http::Request&) { return http::Response{}; }, {}});
  }
  ~EndpointTest() override { jobs_.reset(); }

  PreparedComputation prepare(const EndpointRequest& asked, const Loader& loader) {
    slots_during_preparation_ = jobs_->immediate();
    if (waits_for_stop_)
      while (true) {
        loader.cancellation().throw_if_requested();
        std::this_thread::yield();
      }
    return {.deadline = 60,
            .session = session_,
            .run = [format = std::string(asked.format), length = asked.body.size()](const Execution&) {
              return store::Result{format, {}, std::to_string(length)};
            }};
  }

  static http::Request request_with(std::string body, std::vector<std::pair<std::string, std::string>> headers = {}) {
    http::Request request;
    request.method = "POST";
    request.path = "/v1/echoes";
    request.body = std::move(body);
    request.headers = std::move(headers);
    request.headers.emplace_back("Content-Type", "application/json");
    return request;
  }

  http::Response ask(const http::Request& request) const {
    return router_.find(request.method, request.path).route->handler(request);
  }

  /// The priority of the job that a request with this body becomes.
  Priority priority_of_job(const std::string& body) {
    const auto response = ask(request_with(body, {{"Prefer", "respond-async"}}));
    for (const auto& [name, value] : response.headers)
      if (name == "Location") return jobs_->status(value.substr(std::string("/v1/jobs/").size())).record.priority;
    throw std::runtime_error("no job");
  }

  std::string refusal(const http::Request& request) const {
    return thrown_problem([&] { ask(request); }).code;
  }

  /// The path of the job that a request with the key "mine" becomes.
  std::string job_of(const std::string& accept, const std::string& body = "{}") const {
    const auto response =
        ask(request_with(body, {{"Prefer", "respond-async"}, {"Idempotency-Key", "mine"}, {"Accept", accept}}));
    for (const auto& [name, value] : response.headers)
      if (name == "Location") return value;
    return "none";
  }
  std::string refusal_of_job(const std::string& accept, const std::string& body = "{}") const {
    return refusal(request_with(body, {{"Prefer", "respond-async"}, {"Idempotency-Key", "mine"}, {"Accept", accept}}));
  }

  const testing::TemporaryFolder temporary_folder_;
  const fs::path folder_ = temporary_folder_.path();
  std::unique_ptr<store::Store> store_;
  metrics::Metrics metrics_{"0"};
  Services services_;
  std::unique_ptr<jobs::JobQueue> jobs_;
  http::Router router_;
  int slots_during_preparation_ = -1;
  bool waits_for_stop_ = false;
  std::string session_;
};

TEST_F(EndpointTest, TheFormatIsNegotiatedBeforeTheComputationIsPrepared) {
  EXPECT_EQ(ask(request_with("{}")).content_type, "application/json");
  EXPECT_EQ(ask(request_with("{}", {{"Accept", "text/plain"}})).content_type, "text/plain");
  slots_during_preparation_ = -1;
  EXPECT_EQ(refusal(request_with("{}", {{"Accept", "image/png"}})), "http.not_acceptable");
  auto untyped = request_with("{}");
  untyped.headers.clear();
  EXPECT_EQ(refusal(untyped), "http.unsupported_media_type");
  EXPECT_EQ(slots_during_preparation_, -1) << "neither of them was prepared";
}

TEST_F(EndpointTest, AJobHasThePriorityOfItsRequest) {
  EXPECT_EQ(priority_of_job("{}"), Priority::normal);
  EXPECT_EQ(priority_of_job(R"({"priority":"background"})"), Priority::background);
  session_ = "drag";
  EXPECT_EQ(priority_of_job("{}"), Priority::interactive) << "who sends requests with a session waits for the latest";
  EXPECT_EQ(priority_of_job(R"({"priority":"normal"})"), Priority::normal);
  EXPECT_EQ(ask(request_with(R"({"priority":"background"})")).body, "25") << "also where it becomes no job";
}

TEST_F(EndpointTest, WorkForARequestIsDoneOnItsThreadWhateverItsPriority) {
  jobs::Computation work{.kind = "meshes", .mesh = {}, .deadline = 60, .run = {}};
  work.priority = Priority::background;
  std::thread::id worked_on;
  work_now(services_, request_with("{}"), std::move(work),
           [&](const Execution&) { worked_on = std::this_thread::get_id(); });
  EXPECT_EQ(worked_on, std::this_thread::get_id());
}

/// Counts the requests that leave their slots.
struct CountingStandIn final : http::StandIn {
  void answer(const problem::Problem&, bool) override {}
  void wait_in_background() override { ++waiting; }
  int waiting = 0;
};

TEST_F(EndpointTest, ARequestInTheBackgroundLeavesItsSlotWhileItWaits) {
  CountingStandIn stand_in;
  const auto slots_left = [&](const std::string& body, const std::string& preference) {
    auto request = request_with(body, {{"Prefer", preference}});
    request.stand_in = &stand_in;
    const int before = stand_in.waiting;
    ask(request);
    return stand_in.waiting - before;
  };
  const std::string background = R"({"priority":"background"})";
  EXPECT_EQ(slots_left("{}", ""), 0);
  EXPECT_EQ(slots_left(background, ""), 1);
  EXPECT_EQ(slots_left(background, "wait=1"), 1);
  EXPECT_EQ(slots_left(background, "respond-async"), 0) << "it does not wait";
}

TEST_F(EndpointTest, TheFaultOfAFormatNamesAllThatThereAre) {
  try {
    ask(request_with("{}", {{"Accept", "image/png"}}));
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "An echo is sent as application/json, text/csv or text/plain.");
  }
}

TEST_F(EndpointTest, AKeyOfIdempotencyIsOfOneRepresentation) {
  const auto job = job_of("text/csv");
  EXPECT_EQ(job_of("text/csv;q=0.5, text/plain;q=0.1"), job) << "the same format in other words";
  EXPECT_EQ(refusal_of_job("text/plain"), "job.key_reused");
  EXPECT_EQ(refusal_of_job(""), "job.key_reused") << "JSON";
  EXPECT_EQ(refusal_of_job("text/csv", "{ }"), "job.key_reused") << "another body";
}

TEST_F(EndpointTest, AKeyForTheFirstFormatMeansTheSameJobAsInEarlierVersions) {
  const auto id = job_of("").substr(std::string("/v1/jobs/").size());
  const std::string asked = "POST /v1/echoes\n" + store::sha256("{}");
  EXPECT_EQ(store_->jobs().job(id)->request_hash, store::sha256(asked));
}

TEST_F(EndpointTest, ASmallBodyIsPreparedAtOnceAndALargeOneWithinASlot) {
  ask(request_with("{}"));
  EXPECT_EQ(slots_during_preparation_, 0);
  const std::string large(2 << 20, ' ');
  EXPECT_EQ(ask(request_with(large)).body, std::to_string(large.size()));
  EXPECT_EQ(slots_during_preparation_, 1);
}

TEST_F(EndpointTest, TheDeadlineOfALargeBodyStopsItsPreparation) {
  waits_for_stop_ = true;
  EXPECT_EQ(refusal(request_with(R"({"deadline":0.1,"text":")" + std::string(2 << 20, 'x') + "\"}")),
            "job.deadline_exceeded");
}

TEST_F(EndpointTest, AStoredJobIsPreparedAsItsRequestWas) {
  const store::StoredRequest stored{{"POST", "/v1/echoes", {}, "application/json", "text/csv"}, "{\"a\":1}"};
  const auto computation = computation_of(router_, {}, stored, {});
  EXPECT_EQ(computation.kind, "echoes");
  const auto result = computation.run({});
  EXPECT_EQ(result.content_type, "text/csv");
  EXPECT_EQ(result.body, "7");
}

TEST_F(EndpointTest, AStopRequestEndsTheSecondPreparationOfAStoredJob) {
  waits_for_stop_ = true;
  Execution execution;
  execution.cancellation.request(StopReason::cancelled);
  const store::StoredRequest stored{{"POST", "/v1/echoes", {}, "application/json", ""}, "{}"};
  testing::expect_cancelled(StopReason::cancelled, [&] { computation_of(router_, {}, stored, execution); });
}

TEST_F(EndpointTest, AStoredJobOfARouteThatIsNoEndpointAnyMoreIsInterrupted) {
  const store::StoredRequest stored{{"POST", "/v1/others", {}, "application/json", ""}, "{}"};
  try {
    computation_of(router_, {}, stored, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "job.interrupted");
  }
}

}  // namespace
}  // namespace supple::routes
