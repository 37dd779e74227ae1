#include "supple/base/file_text.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace supple {
namespace {

TEST(FileText, WritesNumbersThatReadBackAsTheSameValue) {
  FileText text;
  text.number(0.1).number(-3).number(1e-300, '\n');
  const std::string written = text.take();
  EXPECT_EQ(written, "0.1 -3 1e-300\n");
  FileText third;
  EXPECT_EQ(std::stod(third.number(1.0 / 3).take()), 1.0 / 3);
}

TEST(FileText, WritesPointsOfThePlaneInSpace) {
  FileText text;
  (text << "v ").point(std::array<double, 3>{1, 2.5, -3});
  text.point(std::array<double, 2>{4, 5});
  EXPECT_EQ(text.take(), "v 1 2.5 -3\n4 5 0\n");
}

TEST(FileText, WritesArraysAsVtkReadsThem) {
  FileText text;
  text.array("UInt8", "types", std::vector<int>{1, 2}, [](int value) { return 2 * value; })
      .open_array("Float64", "p", 3);
  text.close_array();
  EXPECT_EQ(text.take(),
            "<DataArray type=\"UInt8\" Name=\"types\" NumberOfComponents=\"1\" format=\"ascii\">\n2 4 \n</DataArray>\n"
            "<DataArray type=\"Float64\" Name=\"p\" NumberOfComponents=\"3\" format=\"ascii\">\n\n</DataArray>\n");
}

}  // namespace
}  // namespace supple
