#include "supple/json/part_requests.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

namespace supple::json {
namespace {

constexpr double pi = std::numbers::pi;

PartRequest coupon(const std::string& more) {
  return parse_part(
      R"({"outline": {"coupon": {"width": 12, "length": 30}}, "structure": {"family": "IH21"})" + more + "}", {});
}

TEST(PartRequests, TurnTheDesignUntilItsDirectionLiesAlongTheLoad) {
  const PartRequest along_x = coupon(R"(, "direction": 0)");
  EXPECT_DOUBLE_EQ(along_x.orientation_in_part(0), pi / 2);
  EXPECT_DOUBLE_EQ(along_x.orientation_in_part(0.3), 0.3 + pi / 2);
  EXPECT_DOUBLE_EQ(along_x.tested_direction().value_or(-1), 0);
  const PartRequest along_y = coupon(R"(, "direction": 1.5707963267948966)");
  EXPECT_NEAR(along_y.orientation_in_part(0.3), 0.3, 1e-15);
  const PartRequest as_it_lies = coupon("");
  EXPECT_EQ(as_it_lies.orientation_in_part(0.3), 0.3);
  EXPECT_DOUBLE_EQ(as_it_lies.tested_direction().value_or(-1), pi / 2);
}

TEST(PartRequests, SayWhereANeckIsLeft) {
  const PartRequest request = coupon("");
  tiling::Part part;
  part.solid_area = 1;
  part.smallest_neck = 0.0134;
  EXPECT_EQ(part_message(request, part), "");
  part.left_necks = 1;
  EXPECT_NE(part_message(request, part).find("a neck of 13 micrometres"), std::string::npos);
}

}  // namespace
}  // namespace supple::json
