#include "supple/weave/drawing.h"

#include <gtest/gtest.h>

#include "layouts.h"

namespace supple::weave {
namespace {

TEST(Drawing, OfDeformedStrandsIsExactlyTheirLinesWithTwoMillimetresAround) {
  EXPECT_EQ(to_svg({{{0, 0, 5}, {3, 4, 0}}, {{-1, 0, 0}, {1, 1e-12, 0}}}, 0.25),
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-3 -6 8 8\" width=\"8mm\" height=\"8mm\">\n"
            "<path fill=\"none\" stroke=\"#3a6ea5\" stroke-width=\"0.25\" d=\"M0 0L3 -4\"/>\n"
            "<path fill=\"none\" stroke=\"#3a6ea5\" stroke-width=\"0.25\" d=\"M-1 0L1 0\"/>\n"
            "</svg>\n");
  EXPECT_EQ(to_svg(std::vector<std::vector<Eigen::Vector3d>>{}),
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-2 -2 4 4\" width=\"4mm\" height=\"4mm\">\n</svg>\n");
}

TEST(Drawing, OfALayoutHasDotsWhereItIsFusedAndRingsWithALineWhereItSlides) {
  Weave weave;
  weave.strands = {line({-4, 0}, {4, 0}, 0.5), line({0, -4}, {0, 4}, 0.5)};
  weave.crossings = find_crossings(weave.strands);
  const std::string strands =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-6 -6 12 12\" width=\"12mm\" height=\"12mm\">\n"
      "<path fill=\"none\" stroke=\"#3a6ea5\" stroke-width=\"1\" d=\"M-4 0L4 0\"/>\n"
      "<path fill=\"none\" stroke=\"#3a6ea5\" stroke-width=\"1\" d=\"M0 4L0 -4\"/>\n";
  EXPECT_EQ(to_svg(weave), strands + "<circle cx=\"0\" cy=\"0\" r=\"0.8\" fill=\"#b03030\"/>\n</svg>\n");
  weave.crossings[0].members[1].slides = true;
  EXPECT_EQ(to_svg(weave),
            strands +
                "<circle cx=\"0\" cy=\"0\" r=\"0.8\" fill=\"none\" stroke=\"#d08020\" stroke-width=\"0.266667\"/>\n"
                "<path fill=\"none\" stroke=\"#d08020\" stroke-width=\"0.266667\" d=\"M0 1.6L0 -1.6\"/>\n</svg>\n");
}

TEST(Drawing, OfACellHasItsOutlineFromTheFirstStrand) {
  Weave weave;
  weave.strands = {line({1, 1}, {2, 1}, 0.5)};
  weave.lattice = Eigen::Matrix2d{{3, 1}, {0, 2}};
  EXPECT_NE(
      to_svg(weave).find("<path fill=\"none\" stroke=\"#999999\" stroke-width=\"0.1\" d=\"M1 -1L4 -1L5 -3L2 -3Z\"/>\n"),
      std::string::npos);
}

}  // namespace
}  // namespace supple::weave
