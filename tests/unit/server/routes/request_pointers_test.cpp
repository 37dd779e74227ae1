#include "request_pointers.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace supple::routes {
namespace {

using Rest = FieldPlace::Rest;

std::string numbered(const char* array, std::size_t i) { return std::string(array) + std::to_string(i); }

TEST(RequestPointers, AFieldWithoutAPlaceHasTheSamePathBelowTheBase) {
  EXPECT_EQ(PointerMap("").pointer("load/stretches/3"), "/load/stretches/3");
  EXPECT_EQ(PointerMap("/accuracy").pointer("mesh_size"), "/accuracy/mesh_size");
  EXPECT_EQ(PointerMap("/accuracy").pointer(""), "/accuracy");
}

TEST(RequestPointers, APlaceHasItsFieldAndAllBelowItButNotFieldsWhoseNamesBeginAlike) {
  const PointerMap pointers("/accuracy", {{.field = "directions", .pointer = "/directions"}});
  EXPECT_EQ(pointers.pointer("directions"), "/directions");
  EXPECT_EQ(pointers.pointer("directions/4"), "/directions/4");
  EXPECT_EQ(pointers.pointer("directions_too"), "/accuracy/directions_too");
}

TEST(RequestPointers, EntriesOfAnArrayMayBeInAnotherOrderThere) {
  const PointerMap pointers("",
                            {{.field = "overruns",
                              .pointer_of_entry = [](std::size_t strand) { return numbered("/overruns/", strand - 5); },
                              .of_entry_itself = "/strand"}});
  EXPECT_EQ(pointers.pointer("overruns/7/start"), "/overruns/2/start");
  EXPECT_EQ(pointers.pointer("overruns/7"), "/overruns/2/strand");
  EXPECT_EQ(pointers.pointer("overruns"), "/overruns") << "the array itself";
}

TEST(RequestPointers, TheRestOfAPathMayBeDroppedOrNamedInTheMessage) {
  const PointerMap pointers("", {{.field = "solids", .pointer = "/outline", .rest = Rest::dropped},
                                 {.pointer = "/weave", .rest = Rest::in_message}});
  EXPECT_EQ(pointers.pointer("solids/0/1"), "/outline");
  const auto error = pointers({"weave.not_printable", "text", {{"strands/3", "goes on for ever"}}});
  EXPECT_EQ(error.details().at(0).where, "/weave");
  EXPECT_EQ(error.details().at(0).message, "strands/3 goes on for ever");
}

TEST(RequestPointers, MessagesNameEntriesAsTheRequestDoes) {
  const PointerMap pointers(
      "", {{.field = "supports", .pointer_of_entry = [](std::size_t i) { return numbered("/supports/", i / 10); }}});
  const auto error = pointers({"weave.invalid_load",
                               "supports/21: holds what supports/3 holds already (and 1 more)",
                               {{"supports/21", "holds what supports/3 holds already"}, {"lattice", "is for cells"}}});
  EXPECT_EQ(error.details().at(0).where, "/supports/2");
  EXPECT_EQ(error.details().at(0).message, "holds what supports/0 holds already");
  EXPECT_EQ(error.details().at(1).where, "/lattice");
  EXPECT_STREQ(error.what(), "supports/2: holds what supports/0 holds already (and 1 more)");
}

TEST(RequestPointers, WhatIsNoPathStaysAndSoDoJsonPointers) {
  const auto error = PointerMap("/load")({"code", "text", {{"face 17", "is bad"}, {"/mesh", "is bad"}}});
  EXPECT_EQ(error.details().at(0).where, "face 17");
  EXPECT_EQ(error.details().at(1).where, "/mesh");
}

TEST(RequestPointers, OnlyErrorsWithTheirCodesGetPointers) {
  const auto where_of = [](const std::string& code) {
    try {
      with_pointers({{"tiling.", PointerMap("/structure")}, {"weave.invalid_option", PointerMap("/accuracy")}},
                    [&]() -> int {
                      throw Error(code, "text", {{"size", "is bad"}});
                    });
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code);
      return error.details().at(0).where;
    }
    return std::string("none");
  };
  EXPECT_EQ(where_of("tiling.part"), "/structure/size");
  EXPECT_EQ(where_of("weave.invalid_option"), "/accuracy/size");
  EXPECT_EQ(where_of("weave.invalid_options"), "size");
  EXPECT_EQ(where_of("job.cancelled"), "size");
}

TEST(RequestPointers, AFaultOfAFieldIsAFaultOfThisFieldAlone) {
  const auto details_of = [](const std::string& code) {
    try {
      fault_of_field("point.", "/start", [&]() -> int { throw Error(code, "A point is bad.", {{"points/3", "bad"}}); });
    } catch (const Error& error) {
      return error.details().at(0).where + ": " + error.details().at(0).message;
    }
    return std::string("none");
  };
  EXPECT_EQ(details_of("point.outside_face"), "/start: A point is bad.");
  EXPECT_EQ(details_of("job.deadline_exceeded"), "points/3: bad");
}

}  // namespace
}  // namespace supple::routes
