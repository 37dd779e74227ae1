#include "supple/base/number_text.h"

#include <gtest/gtest.h>

#include <limits>

namespace supple {
namespace {

TEST(NumberText, WritesNumbersAsPeopleDo) {
  EXPECT_EQ(number_text(0.3), "0.3");
  EXPECT_EQ(number_text(-2), "-2");
  EXPECT_EQ(number_text(12000), "12000");
  EXPECT_EQ(number_text(1.0 / 3), "0.333333");
  EXPECT_EQ(number_text(0.1 + 0.2), "0.3");
}

TEST(NumberText, LosesNeitherSmallNorLargeNumbers) {
  EXPECT_EQ(number_text(1e-9), "1e-09");
  EXPECT_EQ(number_text(5e-324), "4.94066e-324");
  EXPECT_EQ(number_text(1e300), "1e+300");
  EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(number_text(std::numeric_limits<double>::quiet_NaN()), "nan");
}

}  // namespace
}  // namespace supple
