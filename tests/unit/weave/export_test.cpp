#include "supple/weave/export.h"

#include <gtest/gtest.h>

#include "layouts.h"

namespace supple::weave {
namespace {

const std::vector<std::vector<Eigen::Vector3d>> strands{{{0, 0, 0}, {0.1, 2, 0}, {1, 2, 3}}, {{-1, 0, 0}, {1, 0, 0}}};

TEST(Export, NumbersThePointsOfAnObjFromOneThroughAllStrands) {
  EXPECT_EQ(write_obj(strands), "v 0 0 0\nv 0.1 2 0\nv 1 2 3\nv -1 0 0\nv 1 0 0\nl 1 2 3\nl 4 5\n");
  EXPECT_EQ(write_obj({}), "");
}

TEST(Export, GivesEachPolylineOfAVtuItsStrandAndRadius) {
  Weave weave;
  weave.strands = {line({0, 0}, {1, 0}, 0.25), line({0, 1}, {1, 1}, 0.5)};
  const std::string vtu = write_vtu(weave, strands);
  const auto contains = [&](const std::string& text) { return vtu.find(text) != std::string::npos; };
  EXPECT_TRUE(contains("<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">"));
  EXPECT_TRUE(contains("Name=\"radius\" NumberOfComponents=\"1\" format=\"ascii\">\n0.25 0.5 \n"));
  EXPECT_TRUE(contains("Name=\"connectivity\" NumberOfComponents=\"1\" format=\"ascii\">\n0 1 2 3 4 \n"));
  EXPECT_TRUE(contains("Name=\"offsets\" NumberOfComponents=\"1\" format=\"ascii\">\n3 5 \n"));
  EXPECT_TRUE(contains("Name=\"types\" NumberOfComponents=\"1\" format=\"ascii\">\n4 4 \n"));
  EXPECT_TRUE(contains("0.1 2 0\n1 2 3\n-1 0 0\n"));
}

}  // namespace
}  // namespace supple::weave
