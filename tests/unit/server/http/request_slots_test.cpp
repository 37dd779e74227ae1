#include "request_slots.h"

#include <gtest/gtest.h>

#include "supple/problem/problem.h"

namespace supple::http {
namespace {

/// Code of the problem with which the request is refused; empty if it gets a slot.
std::string refusal(RequestSlots& slots, const std::string& client) {
  const auto refusal = slots.acquire(client);
  return refusal ? problem::problem_of(refusal).code : "";
}

TEST(RequestSlots, AreLimitedInTotalAndForEachClient) {
  RequestSlots slots(3, 0.7);
  EXPECT_EQ(refusal(slots, "a"), "");
  EXPECT_EQ(refusal(slots, "a"), "");
  EXPECT_EQ(refusal(slots, "a"), "server.client_share");
  EXPECT_EQ(refusal(slots, "b"), "");
  EXPECT_EQ(refusal(slots, "b"), "server.busy");
  EXPECT_EQ(slots.occupied(), 3);
  slots.release("a", 1);
  EXPECT_EQ(refusal(slots, "b"), "");
}

TEST(RequestSlots, AreLeftToOthersByRequestsThatWaitInTheBackground) {
  RequestSlots slots(2, 0.5);
  const auto refusal_in_background = [&](const std::string& client) {
    const auto refusal = slots.move_to_background(client);
    return refusal ? problem::problem_of(refusal) : problem::Problem{};
  };
  EXPECT_EQ(refusal(slots, "a"), "");
  EXPECT_EQ(refusal(slots, "a"), "server.client_share");
  EXPECT_EQ(refusal_in_background("a").code, "");
  EXPECT_EQ(refusal(slots, "a"), "") << "its slot is free";
  EXPECT_EQ(refusal_in_background("a").code, "server.client_share");
  EXPECT_EQ(refusal(slots, "b"), "");
  EXPECT_EQ(refusal(slots, "c"), "server.busy") << "both that were refused have kept theirs";
  EXPECT_EQ(refusal_in_background("b").code, "");
  EXPECT_EQ(slots.occupied(), 3);
  EXPECT_EQ(refusal(slots, "c"), "");
  const auto full = refusal_in_background("c");
  EXPECT_EQ(full.code, "server.busy");
  EXPECT_NE(full.detail.find("2 requests in the background"), std::string::npos) << full.detail;
  slots.release_in_background("a");
  EXPECT_EQ(refusal_in_background("c").code, "");
}

TEST(RequestSlots, AreExpectedLaterWhereAnswersTakeLong) {
  RequestSlots slots(1, 1);
  slots.acquire("a");
  EXPECT_EQ(problem::problem_of(slots.acquire("b")).retry_after, 1);
  slots.release("a", 200);
  slots.acquire("a");
  EXPECT_EQ(problem::problem_of(slots.acquire("b")).retry_after, 10) << "the mean counts the last one by a twentieth";
}

}  // namespace
}  // namespace supple::http
