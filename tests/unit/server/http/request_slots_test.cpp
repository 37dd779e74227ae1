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
