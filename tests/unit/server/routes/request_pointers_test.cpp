#include "request_pointers.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "supple/base/cancellation.h"

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

class Fault : public Error {
 public:
  using Error::Error;
};
class FaultOfAKind : public Fault {
 public:
  using Fault::Fault;
};

/// The place and the message of the first detail of the error that a call throws.
template <class Call>
std::string first_detail(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.details().at(0).where + ": " + error.details().at(0).message;
  }
  return "none";
}

TEST(RequestPointers, OnlyErrorsOfTheirTypeGetPointers) {
  const auto detail_of = [](const auto& error) {
    return first_detail([&] { with_pointers<Fault>(PointerMap("/structure"), [&] { throw error; }); });
  };
  EXPECT_EQ(detail_of(Fault("tiling.part", "text", {{"size", "is bad"}})), "/structure/size: is bad");
  EXPECT_EQ(detail_of(FaultOfAKind("tiling.part", "text", {{"size", "is bad"}})), "/structure/size: is bad");
  EXPECT_EQ(detail_of(Error("tiling.part", "text", {{"size", "is bad"}})), "size: is bad") << "whatever its code";
  EXPECT_THROW(with_pointers<Fault>(PointerMap(""), [] { throw Cancelled(StopReason::deadline); }), Cancelled);
  EXPECT_EQ(with_pointers<Fault>(PointerMap(""), [] { return 7; }), 7);
}

TEST(RequestPointers, AnErrorGetsPointersOnce) {
  const auto detail = first_detail([] {
    with_pointers<Fault>(PointerMap("/load"), [] {
      with_pointers<FaultOfAKind>(PointerMap("/accuracy"), [] {
        throw FaultOfAKind("tiling.mesh_option", "text", {{"size", "is bad"}});
      });
    });
  });
  EXPECT_EQ(detail, "/accuracy/size: is bad");
}

TEST(RequestPointers, AFaultOfAFieldIsAFaultOfThisFieldAlone) {
  const auto detail_of = [](const auto& error) {
    return first_detail([&] { fault_of_field<Fault>("/start", [&] { throw error; }); });
  };
  EXPECT_EQ(detail_of(Fault("point.outside_face", "A point is bad.", {{"points/3", "bad"}})),
            "/start: A point is bad.");
  EXPECT_EQ(detail_of(Error("point.outside_face", "A point is bad.", {{"points/3", "bad"}})), "points/3: bad");
}

}  // namespace
}  // namespace supple::routes
