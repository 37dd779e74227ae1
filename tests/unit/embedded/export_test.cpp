#include "supple/embedded/export.h"

#include <gtest/gtest.h>

#include "supple/surface/triangle_mesh.h"

namespace supple::embedded {
namespace {

/// The three corners of a triangle as points, and two springs, of which the second has no path.
struct ExportedNetwork {
  surface::TriangleMesh mesh = surface::TriangleMesh::build({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}});
  Network network;
  Relaxation relaxation;

  ExportedNetwork() {
    relaxation.points = {{FaceId{0}, {1, 0, 0}}, {FaceId{0}, {0, 1, 0}}, {FaceId{0}, {0, 0, 1}}};
    network.points = relaxation.points;
    network.springs = {{0, 1, 0.5, 4}, {1, 2, 3, 1}};
    relaxation.springs.resize(2);
    relaxation.springs[0] = {2, 9, false, true, {}};
    relaxation.springs[0].path = {{relaxation.points[0], {0, 0, 0}},
                                  {{FaceId{0}, {0.5, 0.5, 0}}, {1, 0.1, 0}},
                                  {relaxation.points[1], {2, 0, 0}}};
    relaxation.springs[1] = {2.5, 0.25, true, false, {}};
  }
};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(NetworkExport, DrawsEachSpringOfAnObjAlongItsPathOrStraightWhereItHasNone) {
  const ExportedNetwork small;
  EXPECT_EQ(write_obj(small.mesh, small.network, small.relaxation),
            "v 0 0 0\nv 1 0.1 0\nv 2 0 0\nv 2 0 0\nv 0 2 0\nl 1 2 3\nl 4 5\n");
  EXPECT_EQ(write_obj(small.mesh, {}, {}), "");
}

TEST(NetworkExport, GivesEachPolylineOfAVtuWhatIsKnownOfItsSpring) {
  const ExportedNetwork small;
  const auto vtu = write_vtu(small.mesh, small.network, small.relaxation);
  const auto has_array = [&](const std::string& name, const std::string& values) {
    return contains(vtu, "Name=\"" + name + "\" NumberOfComponents=\"1\" format=\"ascii\">\n" + values + "\n");
  };
  EXPECT_TRUE(contains(vtu, "<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">"));
  EXPECT_TRUE(has_array("length", "2 2.5 "));
  EXPECT_TRUE(has_array("energy", "9 0.25 "));
  EXPECT_TRUE(has_array("rest_length", "0.5 3 "));
  EXPECT_TRUE(has_array("weight", "4 1 "));
  EXPECT_TRUE(has_array("compressed", "0 1 "));
  EXPECT_TRUE(has_array("at_cut_locus", "1 0 "));
  EXPECT_TRUE(has_array("connectivity", "0 1 2 3 4 "));
  EXPECT_TRUE(has_array("offsets", "3 5 "));
  EXPECT_TRUE(has_array("types", "4 4 "));
}

TEST(NetworkExport, HasTheTrianglesOfAMembraneAfterTheSprings) {
  ExportedNetwork small;
  small.network.triangles = {{{0, 1, 2}, {1, 1, 1}}};
  small.relaxation.triangles = {{7, {1.5, 0.5}, false}};
  EXPECT_EQ(write_obj(small.mesh, small.network, small.relaxation),
            "v 0 0 0\nv 1 0.1 0\nv 2 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nv 0 2 0\nl 1 2 3\nl 4 5\nf 6 7 8\n");
  const auto vtu = write_vtu(small.mesh, small.network, small.relaxation);
  const auto has_array = [&](const std::string& name, const std::string& values) {
    return contains(vtu, "Name=\"" + name + "\" NumberOfComponents=\"1\" format=\"ascii\">\n" + values + "\n");
  };
  EXPECT_TRUE(contains(vtu, "<Piece NumberOfPoints=\"8\" NumberOfCells=\"3\">"));
  EXPECT_TRUE(has_array("energy", "9 0.25 7 "));
  EXPECT_TRUE(has_array("weight", "4 1 0 "));
  EXPECT_TRUE(has_array("greater_stretch", "0 0 1.5 "));
  EXPECT_TRUE(has_array("lesser_stretch", "0 0 0.5 "));
  EXPECT_TRUE(has_array("connectivity", "0 1 2 3 4 5 6 7 "));
  EXPECT_TRUE(has_array("offsets", "3 5 8 "));
  EXPECT_TRUE(has_array("types", "4 4 5 "));
  EXPECT_FALSE(contains(write_vtu(small.mesh, ExportedNetwork().network, small.relaxation), "stretch"));
}

TEST(NetworkExport, HasAHostThatGaveWayAfterTheNetwork) {
  ExportedNetwork small;
  small.network.springs.pop_back();
  small.relaxation.springs.pop_back();
  small.relaxation.host.vertices = {{0, 0, 0.5}, {2, 0, 0}, {0, 2, 0}};
  EXPECT_EQ(write_obj(small.mesh, small.network, small.relaxation),
            "o network\nv 0 0 0\nv 1 0.1 0\nv 2 0 0\nl 1 2 3\no host\nv 0 0 0.5\nv 2 0 0\nv 0 2 0\nf 4 5 6\n");
  const std::string shell = write_vtu(small.mesh, small.network, small.relaxation);
  EXPECT_TRUE(contains(shell, "NumberOfPoints=\"6\" NumberOfCells=\"2\""));
  EXPECT_TRUE(contains(shell, "0 1 2\n3 4 5") || contains(shell, "0 1 2 3 4 5")) << shell;
  EXPECT_TRUE(contains(shell, "Name=\"host\""));
  const auto values_of = [](const std::string& text, const std::string& name) {
    const auto begin = text.find('>', text.find("Name=\"" + name + "\"")) + 1;
    std::string values;
    for (const char c : text.substr(begin, text.find('<', begin) - begin))
      if (c >= '0' && c <= '9') values += c;
    return values;
  };
  EXPECT_EQ(values_of(shell, "host"), "01");
  EXPECT_EQ(values_of(shell, "types"), "45");
  // A solid is written with its tetrahedra and without its faces.
  small.relaxation.host.inside = {{0.5, 0.5, -1}};
  small.relaxation.host.tetrahedra = {{0, 1, 2, 3}};
  const std::string solid = write_vtu(small.mesh, small.network, small.relaxation);
  EXPECT_TRUE(contains(solid, "NumberOfPoints=\"7\" NumberOfCells=\"2\""));
  EXPECT_EQ(values_of(solid, "types"), "410");
  EXPECT_EQ(values_of(solid, "offsets"), "37");
  // The corners of a membrane come after the springs and before the host.
  small.network.triangles = {{{0, 1, 2}, {1, 1, 1}}};
  small.relaxation.triangles.resize(1);
  EXPECT_TRUE(contains(write_obj(small.mesh, small.network, small.relaxation), "f 4 5 6\no host\n"));
  EXPECT_TRUE(contains(write_obj(small.mesh, small.network, small.relaxation), "f 7 8 9\n"));
}

TEST(NetworkExport, DrawsConvergenceOnLogarithmicAxesAndLeavesZerosOut) {
  const std::vector<RelaxationStep> history{{100, 10, 0, 0}, {10, 1e-3, 1, 0}, {1, 0, 1, 0}};
  const auto svg = write_convergence_svg(history);
  EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
  EXPECT_EQ(count(svg, "<circle"), 5U);
  for (const char* label : {">1e0<", ">1e1<", ">1e2<", ">1e-3<", ">energy<", ">gradient norm<", ">iteration<"})
    EXPECT_TRUE(contains(svg, label)) << label;
  // The energies are a decade apart each, so that their marks are on a straight line across the panel.
  EXPECT_TRUE(contains(svg, "d=\"M84 34L352 134L620 234\"")) << svg;
}

TEST(NetworkExport, DrawsAnyHistory) {
  EXPECT_TRUE(contains(write_convergence_svg({}), "</svg>"));
  EXPECT_TRUE(contains(write_convergence_svg({{0, 0, 0, 0}}), "</svg>"));
  const auto one = write_convergence_svg({{5, 1e-320, 0, 0}});
  EXPECT_EQ(count(one, "<circle"), 2U);
  EXPECT_FALSE(contains(one, "nan") || contains(one, "inf"));
  const std::vector<RelaxationStep> many(100'001, {1, 1e300, 0, 0});
  const auto long_one = write_convergence_svg(many);
  EXPECT_EQ(count(long_one, "<circle"), 0U);
  EXPECT_LT(count(long_one, "<text"), 40U);
}

}  // namespace
}  // namespace supple::embedded
