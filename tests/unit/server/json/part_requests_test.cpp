#include "supple/json/part_requests.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "supple/base/error.h"

namespace supple::json {
namespace {

constexpr double pi = std::numbers::pi;

PartRequest coupon(const std::string& more) {
  return parse_part(
      R"({"outline": {"coupon": {"width": 12, "length": 30}}, "structure": {"family": "IH21"})" + more + "}", {});
}

TEST(PartRequests, TurnTheDesignUntilItsDirectionLiesAlongTheLoad) {
  const PartRequest along_x = coupon(R"(, "direction": 0)");
  EXPECT_DOUBLE_EQ(along_x.orientation_in_part(along_x.filling), pi / 2);
  const PartRequest turned = coupon(R"(, "direction": 0, "orientation": 0.3)");
  EXPECT_DOUBLE_EQ(turned.orientation_in_part(turned.filling), 0.3 + pi / 2);
  EXPECT_DOUBLE_EQ(along_x.tested_direction().value_or(-1), 0);
  const PartRequest along_y = coupon(R"(, "direction": 1.5707963267948966, "orientation": 0.3)");
  EXPECT_NEAR(along_y.orientation_in_part(along_y.filling), 0.3, 1e-15);
  const PartRequest as_it_lies = coupon(R"(, "orientation": 0.3)");
  EXPECT_EQ(as_it_lies.orientation_in_part(as_it_lies.filling), 0.3);
  EXPECT_DOUBLE_EQ(as_it_lies.tested_direction().value_or(-1), pi / 2);
}

PartRequest sheet(const std::string& more) {
  return parse_part(R"({"outline": {"rectangle": [20, 30]}, "structure": {"family": "IH21"})" + more + "}", {});
}

TEST(PartRequests, TurnTheStructuresOfADrawingTowardsItsAxis) {
  const std::string region = R"("outline": [[0, 0], [5, 0], [5, 5]], "structure": {"family": "IH29"})";
  const PartRequest request = sheet(R"(, "axis": 0.5, "direction": 0.2, "orientation": 0.1, "regions": [{)" + region +
                                    R"(}, {)" + region + R"(, "direction": 0.4}])");
  EXPECT_DOUBLE_EQ(request.orientation_in_part(request.filling), 0.1 + 0.5 - 0.2);
  EXPECT_DOUBLE_EQ(request.tested_direction().value_or(-1), 0.2);
  EXPECT_DOUBLE_EQ(request.orientation_in_part(request.regions.at(0).filling), 0.5 - 0.2);
  EXPECT_DOUBLE_EQ(request.orientation_in_part(request.regions.at(1).filling), 0.5 - 0.4);
  const PartRequest only_axis = sheet(R"(, "axis": 0.5, "orientation": 0.1)");
  EXPECT_EQ(only_axis.orientation_in_part(only_axis.filling), 0.1);
  EXPECT_DOUBLE_EQ(only_axis.tested_direction().value_or(-1), 0.5);
  EXPECT_FALSE(sheet("").tested_direction().has_value());
}

TEST(PartRequests, RefuseAnAxisOfACouponAndADirectionWithoutAxis) {
  const auto refused = [](auto parse) {
    try {
      parse();
    } catch (const Error& error) {
      return error.details().at(0).where;
    }
    return std::string();
  };
  EXPECT_EQ(refused([] { coupon(R"(, "axis": 1)"); }), "/axis");
  EXPECT_EQ(refused([] { sheet(R"(, "direction": 1)"); }), "/direction");
}

TEST(PartRequests, WhoseRegionsAreTheOutlineHaveTheWallsOfTheRegions) {
  const PartRequest request = parse_part(
      R"({"outline": {"regions": true}, "structure": {"family": "IH21"}, "regions": [
          {"outline": [[0, 0], [5, 0], [5, 5]], "structure": {"family": "IH29"}, "beam_width": 0.6}]})",
      {});
  EXPECT_TRUE(request.design.outline_of_regions);
  EXPECT_TRUE(request.design.outline.empty());
  EXPECT_DOUBLE_EQ(request.design.smallest_wall, 0.4);
  EXPECT_DOUBLE_EQ(request.design.seam, 0.6);
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
