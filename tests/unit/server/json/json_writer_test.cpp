#include "supple/json/json_writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "supple/base/error.h"
#include "supple/json/answers.h"

namespace supple::json {
namespace {

TEST(JsonWriter, KeepsTrackOfCommas) {
  JsonWriter out;
  out.begin_object().field("a", 1).field("b", true).key("c").begin_array().end_array();
  out.key("d").numbers(std::vector<double>{1, 0.5}).key("e").null().field("f", "x").end_object();
  EXPECT_EQ(out.take(), R"({"a":1,"b":true,"c":[],"d":[1,0.5],"e":null,"f":"x"})");
}

TEST(JsonWriter, WritesNumbersThatReadBackAsTheSameDouble) {
  for (const double value : {0.1, 1.0 / 3, 1e-300, 123456789.123456789, std::numeric_limits<double>::max(), 5e-324}) {
    JsonWriter out;
    out.number(value);
    EXPECT_EQ(std::strtod(out.take().c_str(), nullptr), value);
  }
}

TEST(JsonWriter, RefusesNumbersThatAreNotFiniteAndNamesTheirKey) {
  for (const double value :
       {std::nan(""), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    JsonWriter out;
    out.begin_object();
    try {
      out.field("objective", value);
      FAIL() << "wrote " << value;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), "computation.non_finite");
      EXPECT_NE(std::string(error.what()).find("objective"), std::string::npos);
    }
  }
}

TEST(JsonWriter, EscapesTextAndReplacesWhatIsNotUtf8) {
  JsonWriter out;
  out.begin_array()
      .string("a\"b\\c\n\x01")
      .string("\xC3\xA9\xF0\x9F\x98\x80")
      .string("\xFFx\xC3")
      .string("\xED\xA0\x80")
      .end_array();
  EXPECT_EQ(out.take(),
            "[\"a\\\"b\\\\c\\u000a\\u0001\",\"\xC3\xA9\xF0\x9F\x98\x80\",\"\xEF\xBF\xBDx\xEF\xBF\xBD\","
            "\"\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD\"]");
}

TEST(JsonWriter, WritesAProblemAsRfc9457DescribesIt) {
  problem::Problem problem{
      "mesh.not_found", "There is no mesh x.", {{"/mesh", "unknown"}}, problem::Limit{1, 2, "--max-x"}, {}};
  EXPECT_EQ(
      write_problem(problem),
      R"({"type":"urn:supple:error:mesh.not_found","title":"No such mesh","status":404,"detail":"There is no mesh x.",)"
      R"("code":"mesh.not_found","hint":"Upload it with POST /v1/meshes; the answer's id names it.",)"
      R"("errors":[{"pointer":"/mesh","detail":"unknown"}],"limit":1,"value":2,"setting":"--max-x"})");
}

TEST(JsonWriter, RefusesAnAnswerBeyondItsLimit) {
  constexpr std::size_t usual = std::size_t{256} << 20;
  set_answer_limit(1000);
  JsonWriter out;
  out.begin_array();
  const auto code = [&]() -> std::string {
    try {
      for (int i = 0; i < 10'000; ++i) out.integer(i);
    } catch (const Error& error) {
      return error.code();
    }
    return "none";
  }();
  set_answer_limit(usual);
  EXPECT_EQ(code, "answer.too_large");
  EXPECT_LT(out.take().size(), 1100U);
}

TEST(JsonWriter, WritesTimesInUtc) { EXPECT_EQ(time_text(1'700'000'000'042), "2023-11-14T22:13:20.042Z"); }

}  // namespace
}  // namespace supple::json
