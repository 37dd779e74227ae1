#include "supple/microscale/part_files.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "supple/microscale/part_mesh_error.h"
#include "supple/microscale/part_strain.h"
#include "supple/microscale/vtu.h"
#include "support/drawn_meshes.h"

namespace supple::microscale {
namespace {

/// A square of two by two squares that lies alone in its cell.
tiling::PeriodicMesh lone_square() {
  tiling::PeriodicMesh mesh = testing::draw({"...", "##.", "##."}, {0.5, 0.5, 4}, {0.5, 0.5, 4});
  mesh.mesh_size = 0.5;
  return mesh;
}

/// Displacements of the nodes that stretch everything along x.
Eigen::Matrix2Xd displacements_when_stretched(const tiling::PeriodicMesh& mesh, double strain) {
  Eigen::Matrix2Xd displacements = Eigen::Matrix2Xd::Zero(2, mesh.nodes.cols());
  displacements.row(0) = strain * mesh.nodes.row(0);
  return displacements;
}

PartState stretched_state(const tiling::PeriodicMesh& mesh, double strain) {
  PartState state;
  state.displacements = displacements_when_stretched(mesh, strain);
  state.supports.resize(2);
  return state;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

TEST(PartFiles, PicturesOfAllStatesHaveOneFrameAndOneScale) {
  const auto mesh = lone_square();
  const std::vector<PartState> states{stretched_state(mesh, 0.1), stretched_state(mesh, 0.5),
                                      stretched_state(mesh, -0.2)};
  const PictureFrame frame = picture_frame(mesh, states);
  EXPECT_NEAR(frame.lower.norm(), 0, 1e-12);
  EXPECT_NEAR(frame.upper.x(), 1.5, 1e-12);
  EXPECT_NEAR(frame.upper.y(), 1, 1e-12);
  EXPECT_NEAR(frame.full_strain, 0.5, 1e-12);
}

TEST(PartFiles, APartAtRestHasAScaleThatIsNotEmpty) {
  const auto mesh = lone_square();
  const PictureFrame frame = picture_frame(mesh, {stretched_state(mesh, 0)});
  EXPECT_GT(frame.full_strain, 0);
  EXPECT_NE(write_part_svg(mesh, displacements_when_stretched(mesh, 0), frame).find("rgb(32,18,77)"),
            std::string::npos);
}

TEST(PartFiles, APictureHasEachTriangleInTheColourOfItsStrain) {
  const auto mesh = lone_square();
  const PictureFrame frame = picture_frame(mesh, {stretched_state(mesh, 0.5)});
  const std::string svg = write_part_svg(mesh, displacements_when_stretched(mesh, 0.5), frame);
  EXPECT_EQ(count_of(svg, "Z\n"), mesh.triangles.size());
  EXPECT_EQ(count_of(svg, "<path"), 1U) << "all triangles have the same strain";
  EXPECT_NE(svg.find("<path fill=\"rgb(245,228,60)\""), std::string::npos) << "the last colour";
  EXPECT_NE(svg.find("strain from 0 to 50 % and more"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(PartFiles, AnObjHasFourTrianglesForEachQuadraticOne) {
  const auto mesh = lone_square();
  std::istringstream lines(write_part_obj(mesh, displacements_when_stretched(mesh, 0.5)));
  Eigen::Index vertices = 0;
  std::vector<Eigen::Vector2d> points;
  double area = 0;
  for (std::string word; lines >> word;) {
    if (word == "v") {
      Eigen::Vector2d p(0, 0);
      double z = 1;
      lines >> p.x() >> p.y() >> z;
      EXPECT_EQ(z, 0);
      points.push_back(p);
      ++vertices;
    } else if (word == "f") {
      std::size_t a = 0, b = 0, c = 0;
      lines >> a >> b >> c;
      Eigen::Matrix2d sides;
      sides << points.at(b - 1) - points.at(a - 1), points.at(c - 1) - points.at(a - 1);
      EXPECT_GT(sides.determinant(), 0) << "the triangles are counterclockwise";
      area += sides.determinant() / 2;
    }
  }
  EXPECT_EQ(vertices, mesh.nodes.cols());
  EXPECT_NEAR(area, 1.5, 1e-12);
}

TEST(PartFiles, AVtuHasTheStrainOfEachTriangle) {
  const auto mesh = lone_square();
  const std::string vtu = write_part_vtu(mesh, displacements_when_stretched(mesh, 0.25), {});
  EXPECT_NE(vtu.find("NumberOfCells=\"" + std::to_string(mesh.triangles.size()) + "\""), std::string::npos);
  const auto begin = vtu.find('>', vtu.find("Name=\"largest_strain\""));
  std::istringstream numbers(vtu.substr(begin + 1, vtu.find("</DataArray>", begin) - begin - 1));
  std::size_t count = 0;
  for (double strain = 0; numbers >> strain; ++count) EXPECT_NEAR(strain, 0.25, 1e-12);
  EXPECT_EQ(count, mesh.triangles.size());
}

TEST(PartFiles, ATableHasALineForEachState) {
  const auto mesh = lone_square();
  std::vector<PartState> states{stretched_state(mesh, 0.1), stretched_state(mesh, 0.2)};
  states[0].fraction = 0.5;
  states[0].supports[1].force = {1, -2.5};
  states[0].supports[1].displacement = {0, 0.25};
  states[1].residual = std::numeric_limits<double>::quiet_NaN();
  states[1].stopped = PartStop::lost_support;
  std::istringstream lines(write_part_csv(states));
  std::string titles, first, second, rest;
  std::getline(lines, titles);
  std::getline(lines, first);
  std::getline(lines, second);
  EXPECT_FALSE(std::getline(lines, rest));
  EXPECT_EQ(titles,
            "state,share,displacement_x_0,displacement_y_0,force_x_0,force_y_0,touching_0,displacement_x_1,"
            "displacement_y_1,force_x_1,force_y_1,touching_1,energy,largest_strain,contacts,stable,branch,stopped,"
            "residual,iterations,load_steps");
  EXPECT_EQ(first, "0,0.5,0,0,0,0,0,0,0.25,1,-2.5,0,0,0,0,true,0,converged,0,0,0");
  EXPECT_NE(second.find(",lost_support,,0,0"), std::string::npos) << second;
  EXPECT_EQ(count_of(first, ","), count_of(titles, ","));
}

PartSimulationResult path_of_forces(const std::vector<double>& forces) {
  PartSimulationResult result;
  for (const double force : forces) {
    PartState state;
    state.supports.resize(1);
    state.supports[0].force = {0, force};
    state.energy = force * force;
    result.states.push_back(state);
  }
  return result;
}

TEST(PartMeshError, IsTheDifferenceFromTheCoarseMesh) {
  const auto error = part_mesh_error(path_of_forces({3, 4}), path_of_forces({3.3, 4.4}));
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->force, 0.1, 1e-12);
  EXPECT_NEAR(error->energy, 0.21, 1e-12);
}

TEST(PartMeshError, IsUnknownWhereTheCoarseMeshDoesNotArrive) {
  EXPECT_FALSE(part_mesh_error(path_of_forces({3, 4}), path_of_forces({3.3})));
  auto stopped = path_of_forces({3, 4});
  stopped.states[1].stopped = PartStop::step_too_small;
  EXPECT_FALSE(part_mesh_error(path_of_forces({3, 4}), stopped));
  EXPECT_TRUE(part_mesh_error(stopped, path_of_forces({3.3}))) << "a state that did not converge does not count";
  EXPECT_FALSE(part_mesh_error({}, {}));
}

TEST(PartMeshError, IsZeroWhereNothingIsPressed) {
  const auto error = part_mesh_error(path_of_forces({0}), path_of_forces({0}));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->force, 0);
  EXPECT_FALSE(part_mesh_error(path_of_forces({0}), path_of_forces({1})));
}

}  // namespace
}  // namespace supple::microscale
