#include "supple/json/requests.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "supple/budget/memory.h"
#include "supple/problem/problem.h"
#include "support/expect_error.h"

namespace supple::json {
namespace {

const std::string id(64, 'a');

std::string with_mesh(const std::string& fields) { return "{\"mesh\":\"" + id + "\"," + fields + "}"; }

/// The error that a call throws; fails the test where it throws none.
Error error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return {"", ""};
}

Error geodesics_error(const std::string& body, const Limits& limits = {}) {
  return error_of([&] { parse_geodesics(body, limits); });
}

std::vector<std::string> pointers(const Error& error) {
  std::vector<std::string> result;
  for (const auto& detail : error.details()) result.push_back(detail.where);
  return result;
}

using Pointers = std::vector<std::string>;

TEST(Requests, ReadEveryFieldOfAGeodesicsRequest) {
  const auto request = parse_geodesics(
      with_mesh(
          R"("pairs":[{"from":{"vertex":3},"to":{"face":2,"barycentric":[0.5,0.25,0.25]},"known_path":[{"vertex":3},{"vertex":4}]}],
        "derivatives":2,"paths":true,"accuracy":{"mollifier_length":0.01},"effects":{"mollifier":"on"},"deadline":5)"),
      {});
  EXPECT_EQ(request.mesh, id);
  ASSERT_EQ(request.pairs.size(), 1U);
  EXPECT_TRUE(request.pairs[0].from.by_vertex);
  EXPECT_EQ(request.pairs[0].from.index, 3);
  EXPECT_EQ(request.pairs[0].to.barycentric, Eigen::Vector3d(0.5, 0.25, 0.25));
  EXPECT_EQ(request.pairs[0].known_path.size(), 2U);
  EXPECT_EQ(request.derivatives, 2);
  EXPECT_TRUE(request.paths);
  EXPECT_EQ(request.mollifier_length, 0.01);
  EXPECT_EQ(request.mollifier, Switch::on);
  EXPECT_EQ(request.deadline, 5);
}

TEST(Requests, PointToEachFieldAtFault) {
  const auto error = geodesics_error(with_mesh(
      R"("pairs":[{"from":{"vertex":-1},"to":{"face":0}},{"from":{"face":1,"barycentric":[1,2]}}],"derivatives":3)"));
  EXPECT_EQ(error.code(), "request.invalid");
  EXPECT_EQ(pointers(error), (Pointers{"/pairs/0/from/vertex", "/pairs/0/to/barycentric", "/pairs/1/from/barycentric",
                                       "/pairs/1/to", "/derivatives"}));
}

TEST(Requests, SuggestTheFieldThatAnUnknownOneResembles) {
  const auto error =
      geodesics_error(with_mesh(R"("pairs":[{"from":{"vertex":1},"to":{"vertex":2}}],"derivative":1,"a/b~c":1)"));
  EXPECT_EQ(pointers(error), (Pointers{"/a~1b~0c", "/derivative"}));
  EXPECT_EQ(error.details()[1].message, "unknown field; did you mean \"derivatives\"?");
}

TEST(Requests, NameNoMoreThanTwentyFaultsAndTheirNumber) {
  std::string pairs;
  for (int i = 0; i < 30; ++i) pairs += std::string(i ? "," : "") + "{}";
  const auto error = geodesics_error(with_mesh("\"pairs\":[" + pairs + "]"));
  EXPECT_EQ(error.details().size(), 20U);
  EXPECT_NE(std::string(error.what()).find("(and 59 more)"), std::string::npos) << error.what();
}

TEST(Requests, RefuseNestingBeyondTheLimit) {
  const auto nested = [](int depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_EQ(geodesics_error(nested(32)).code(), "request.invalid");
  EXPECT_EQ(geodesics_error(nested(33)).code(), "request.too_deep");
  EXPECT_EQ(geodesics_error(std::string(2'000'000, '[')).code(), "request.too_deep");
}

TEST(Requests, RefuseMoreValuesThanTheLimitAndNameTheSetting) {
  Limits limits;
  limits.max_values = 10;
  try {
    parse_geodesics("[1,2,3,4,5,6,7,8,9,10]", limits);
    FAIL() << "nothing was thrown";
  } catch (const problem::ProblemError& error) {
    EXPECT_EQ(error.code(), "request.too_many_values");
    EXPECT_EQ(error.problem().limit->setting, "--max-json-values");
    EXPECT_EQ(error.problem().limit->value, 11);
  }
}

TEST(Requests, RefuseMorePairsThanTheLimitAndPointToThem) {
  Limits limits;
  limits.max_pairs = 1;
  const auto error = geodesics_error(with_mesh(R"("pairs":[{},{}])"), limits);
  EXPECT_EQ(error.code(), "request.limit_exceeded");
  EXPECT_EQ(pointers(error), Pointers{"/pairs"});
}

TEST(Requests, RefuseWhatIsNotJson) {
  for (const char* body :
       {"", "{", "{\"a\":}", "[1,]", "nul", "{\"a\":1}x", "[NaN]", "[Infinity]", "[1e999]", "\"\\ud800\"", "'a'"}) {
    EXPECT_EQ(geodesics_error(body).code(), "request.malformed_json") << body;
  }
}

TEST(Requests, RefuseAKeyThatIsGivenTwice) {
  EXPECT_EQ(geodesics_error(R"({"mesh":"a","mesh":"b"})").code(), "request.malformed_json");
}

TEST(Requests, RefuseWhatIsNotUtf8WithTheByte) {
  const auto error = geodesics_error("{\"mesh\":\"aaaaaaaaaaaa\xC0\xAF\"}");
  EXPECT_EQ(error.code(), "request.not_utf8");
  EXPECT_NE(std::string(error.what()).find("byte 21"), std::string::npos) << error.what();
}

TEST(Requests, RefuseADeadlineBeyondTheMaximumAndTakeTheDefaultWithoutOne) {
  const auto body = [](const std::string& more) { return with_mesh("\"sources\":[{\"vertex\":0}]" + more); };
  Limits limits;
  limits.max_deadline = 20;
  limits.default_deadline = 10;
  EXPECT_EQ(parse_geodesic_field(body(""), limits).deadline, 10);
  EXPECT_EQ(error_of([&] { parse_geodesic_field(body(",\"deadline\":21"), limits); }).code(), "request.limit_exceeded");
  EXPECT_EQ(pointers(error_of([&] { parse_geodesic_field(body(",\"deadline\":0"), limits); })), Pointers{"/deadline"});
}

TEST(Requests, RefuseAnErrorGuaranteeThatTheMethodCannotGive) {
  const auto body = with_mesh(R"("sources":[{"vertex":0}],"accuracy":{"method":"edge_graph","relative_error":0.1})");
  EXPECT_EQ(pointers(error_of([&] { parse_geodesic_field(body, {}); })), Pointers{"/accuracy/relative_error"});
}

TEST(Requests, ReadAKarcherMeanRequestWithItsDefaults) {
  const auto request =
      parse_karcher_mean(with_mesh(R"("points":[{"vertex":0}],"method":"lbfgs","effects":{"kept_fields":"off"})"), {});
  EXPECT_EQ(request.tolerance, 1e-9);
  EXPECT_EQ(request.max_iterations, 200);
  EXPECT_EQ(request.starts, 1);
  EXPECT_FALSE(request.start);
  EXPECT_EQ(request.method, surface::MinimizationMethod::lbfgs);
  EXPECT_EQ(request.kept_fields, Switch::off);
}

TEST(Requests, TakeATangentInSpaceOrInTheFrame) {
  const auto body = [](const std::string& tangent) {
    return with_mesh("\"start\":{\"vertex\":0},\"tangent\":" + tangent);
  };
  EXPECT_EQ(parse_exponential_map(body("[1,2]"), {}).tangent.size(), 2U);
  EXPECT_EQ(parse_exponential_map(body("[1,2,3]"), {}).tangent.size(), 3U);
  EXPECT_EQ(pointers(error_of([&] { parse_exponential_map(body("[1]"), {}); })), Pointers{"/tangent"});
  EXPECT_EQ(pointers(error_of([&] { parse_exponential_map(body("[1,\"x\"]"), {}); })), Pointers{"/tangent/1"});
}

TEST(Requests, ReadMeshArraysAndNameTheFaultyRows) {
  const auto upload = parse_mesh_arrays(R"({"vertices":[[0,0,0],[1,0,0],[0,1,0]],"faces":[[0,1,2]]})", {}, {}, {});
  EXPECT_FALSE(upload.repair);
  const auto& soup = upload.soup;
  EXPECT_EQ(soup.positions.size(), 3U);
  EXPECT_EQ(soup.faces[0], (surface::Triangle{0, 1, 2}));
  const auto error = error_of(
      [] { parse_mesh_arrays(R"({"vertices":[[0,0]],"faces":[[0,1,-2],[0,1.5,2],[0,1,4294967296]]})", {}, {}, {}); });
  EXPECT_EQ(pointers(error), (Pointers{"/vertices/0", "/faces/0", "/faces/1", "/faces/2"}));
}

TEST(Requests, ReadTheRepairsOfAMeshAndNameTheFaultyOnes) {
  const auto parsed = [](const std::string& more) {
    return parse_mesh_arrays(R"({"vertices":[[0,0,0],[1,0,0],[0,1,0]],"faces":[[0,1,2]],)" + more + "}", {}, {}, {});
  };
  using surface::Repair;
  const auto plain = parsed(R"("repair":["split_non_manifold","weld"])").repair.value();
  EXPECT_TRUE(plain.has(Repair::weld) && plain.has(Repair::split_non_manifold));
  EXPECT_FALSE(plain.has(Repair::drop_degenerate) || plain.has(Repair::drop_duplicates));
  EXPECT_FALSE(plain.weld_tolerance || plain.automatic);
  EXPECT_TRUE(parsed(R"("repair":["automatic"])").repair.value().automatic);
  EXPECT_EQ(parsed(R"("repair":["weld"],"weld_tolerance":0)").repair.value().weld_tolerance, 0);
  const auto faulty = [&](const std::string& more) { return pointers(error_of([&] { parsed(more); })); };
  EXPECT_EQ(faulty(R"("repair":[])"), Pointers{"/repair"});
  EXPECT_EQ(faulty(R"("repair":["weld","automatic"])"), Pointers{"/repair/1"});
  EXPECT_EQ(faulty(R"("repair":["automatic"],"weld_tolerance":0.001)"), Pointers{"/weld_tolerance"});
  EXPECT_EQ(faulty(R"("repair":"weld")"), Pointers{"/repair"});
  EXPECT_EQ(faulty(R"("repair":["weld","Weld",3])"), (Pointers{"/repair/1", "/repair/2"}));
  EXPECT_EQ(faulty(R"("repair":["weld"],"weld_tolerance":0.011)"), Pointers{"/weld_tolerance"});
  EXPECT_EQ(faulty(R"("repair":["drop_degenerate"],"weld_tolerance":0.001)"), Pointers{"/weld_tolerance"});
  EXPECT_EQ(faulty(R"("weld_tolerance":0.001)"), Pointers{"/weld_tolerance"});
}

TEST(Requests, ReserveTheMemoryOfTheirJsonBeforeTheyTakeIt) {
  const auto code = [](std::int64_t each, const std::string& body) {
    budget::MemoryBudget budget(1LL << 30, each);
    budget::MemoryBudget::Reservation reservation(budget);
    const budget::RequestMemory memory(reservation);
    return error_of([&] { parse_geodesic_field(body, {}); }).code();
  };
  std::string arrays = "[";
  for (int i = 0; i < 100'000; ++i) arrays += "[],";
  arrays += "0]";
  EXPECT_EQ(code(4 << 20, arrays), "request.too_much_memory");
  EXPECT_EQ(code(64 << 20, arrays), "request.invalid");
}

TEST(Requests, AreReadNoFurtherOnceAStopIsAskedFor) {
  const CancellationToken stopped;
  stopped.request(StopReason::deadline);
  std::string numbers;
  for (int i = 0; i < 20'000; ++i) numbers += "0,";
  testing::expect_cancelled(StopReason::deadline, [&] { parse_mesh_arrays('[' + numbers + '?', {}, {}, stopped); });
  EXPECT_EQ(error_of([&] { parse_mesh_arrays('[' + numbers + '?', {}, {}, {}); }).code(), "request.malformed_json");
}

TEST(Requests, WithoutAMeshAreReadNoFurtherEither) {
  std::string body = R"({"mesh":")" + std::string(64, '0') + R"(","points":[{"vertex":0})";
  for (int i = 0; i < 20'000; ++i) body += R"(,{"vertex":1})";
  body += "]}";
  CancellationToken token;
  EXPECT_EQ(parse_karcher_mean(body, {}, token).points.size(), 20'001U);
  token.request(StopReason::deadline);
  testing::expect_cancelled(StopReason::deadline, [&] { parse_karcher_mean(body, {}, token); });
}

TEST(Requests, TellTheirDeadlineBeforeTheyAreParsed) {
  const Limits limits;
  const auto peek = [&](const std::string& body) { return peek_deadline(body, limits); };
  EXPECT_EQ(peek(R"({"mesh":"x", "deadline" : 2.5, "points":[]})"), 2.5);
  EXPECT_EQ(peek(R"({"deadline":1e9})"), limits.max_deadline);
  EXPECT_EQ(peek(R"({"points":[{"deadline":3}],"text":"\"deadline\":4"})"), limits.default_deadline)
      << "none of its own";
  for (const char* body : {"", "{", "\"deadline", "\"\\", R"({"deadline")", R"({"deadline":)", R"({"deadline":"2"})",
                           R"({"deadline":-1})"})
    EXPECT_EQ(peek(body), limits.default_deadline) << body;
}

TEST(Requests, TellTheirPriorityBeforeTheyAreParsed) {
  EXPECT_EQ(peek_priority(R"({"mesh":"x", "priority" : "background", "points":[]})"), Priority::background);
  EXPECT_EQ(peek_priority(R"({"priority":"normal","priority":"interactive"})"), Priority::interactive)
      << "as parsers do";
  for (const char* body : {"", "{", R"({"priority)", R"({"priority":)", R"({"priority":"backgr)", R"({"priority":2})",
                           R"({"priority":"urgent"})", R"({"inner":{"priority":"background"}})",
                           R"({"text":"\"priority\":\"background\""})"})
    EXPECT_FALSE(peek_priority(body)) << body;
}

TEST(Requests, RefuseAPriorityThatThereIsNot) {
  const std::string begin = R"({"mesh":")" + std::string(64, '0') + R"(","points":[{"vertex":0}],"priority":)";
  EXPECT_EQ(parse_karcher_mean(begin + R"("background"})", {}).points.size(), 1U);
  const auto error = error_of([&] { parse_karcher_mean(begin + R"("urgent"})", {}); });
  EXPECT_EQ(error.code(), "request.invalid");
  ASSERT_EQ(error.details().size(), 1U);
  EXPECT_EQ(error.details()[0].where, "/priority");
}

TEST(Requests, RefuseMoreFacesThanTheLimit) {
  surface::MeshLimits limits;
  limits.faces = 1;
  const auto error =
      error_of([&] { parse_mesh_arrays(R"({"vertices":[],"faces":[[0,1,2],[0,1,2]]})", {}, limits, {}); });
  EXPECT_EQ(error.code(), "mesh.too_large");
}

}  // namespace
}  // namespace supple::json
