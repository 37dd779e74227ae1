#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "supple/base/random.h"
#include "supple/surface/mesh_io.h"
#include "support/expect_error.h"

namespace supple::surface {
namespace {

using Corners = std::vector<Eigen::Vector3d>;
using testing::expect_error;

std::string digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string obj_of(const Corners& corners) {
  std::string text;
  for (const auto& p : corners) text += "v " + digits(p[0]) + " " + digits(p[1]) + " " + digits(p[2]) + "\n";
  text += "f";
  for (std::size_t i = 1; i <= corners.size(); ++i) text += " " + std::to_string(i);
  return text + "\n";
}

Corners flat(const std::vector<std::array<double, 2>>& points) {
  Corners corners;
  for (const auto& [x, y] : points) corners.emplace_back(x, y, 0);
  return corners;
}

/// The area that the polygon's corners enclose, as a vector along its normal: half the sum of p x q over its sides,
/// from its first corner.
Eigen::Vector3d area_vector(const Corners& corners) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 2; i < corners.size(); ++i) {
    sum += (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]) / 2;
  }
  return sum;
}

/// Cuts the polygon and expects triangles that cover it once: all face to its side, their areas sum to its area, they
/// are as many as its corners less two, and every side of the polygon is the side of one triangle.
TriangleSoup expect_cut_rightly(const Corners& corners, double tolerance = 1e-12) {
  const TriangleSoup soup = read_mesh(obj_of(corners), MeshFormat::obj);
  EXPECT_EQ(soup.faces.size(), corners.size() - 2);
  const Eigen::Vector3d normal = area_vector(corners).normalized();
  double sum = 0;
  std::multiset<std::pair<std::int32_t, std::int32_t>> sides;
  for (const auto& [a, b, c] : soup.faces) {
    const Eigen::Vector3d doubled =
        (soup.positions[b] - soup.positions[a]).cross(soup.positions[c] - soup.positions[a]);
    EXPECT_GT(doubled.dot(normal), 0) << a << " " << b << " " << c;
    sum += doubled.dot(normal) / 2;
    for (const auto& side : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) sides.insert(side);
  }
  EXPECT_NEAR(sum, area_vector(corners).norm(), tolerance * area_vector(corners).norm());
  const auto n = static_cast<std::int32_t>(corners.size());
  for (std::int32_t i = 0; i < n; ++i) EXPECT_EQ(sides.count({i, (i + 1) % n}), 1u) << "side from corner " << i;
  return soup;
}

/// The smallest angle of all triangles, in radians.
double smallest_angle(const TriangleSoup& soup) {
  double smallest = std::numbers::pi;
  for (const Triangle& face : soup.faces) {
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d u = soup.positions[face[(i + 1) % 3]] - soup.positions[face[i]];
      const Eigen::Vector3d v = soup.positions[face[(i + 2) % 3]] - soup.positions[face[i]];
      smallest = std::min(smallest, std::atan2(u.cross(v).norm(), u.dot(v)));
    }
  }
  return smallest;
}

Corners star(int points) {
  Corners corners;
  for (int i = 0; i < 2 * points; ++i) {
    const double angle = std::numbers::pi * i / points, radius = i % 2 == 0 ? 1 : 0.3;
    corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  return corners;
}

/// A back of height 1 over the teeth, each of width 1 and height 3, with gaps of width 1: its area is 5 teeth - 1.
Corners comb(int teeth) {
  Corners corners;
  for (int i = 0; i < teeth; ++i) {
    corners.emplace_back(2 * i, 0, 0);
    corners.emplace_back(2 * i + 1, 0, 0);
    if (i + 1 == teeth) break;
    corners.emplace_back(2 * i + 1, 3, 0);
    corners.emplace_back(2 * i + 2, 3, 0);
  }
  corners.emplace_back(2 * teeth - 1, 4, 0);
  corners.emplace_back(0, 4, 0);
  return corners;
}

Corners rotated_to_start_at(Corners corners, std::size_t first) {
  std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(first), corners.end());
  return corners;
}

Eigen::Matrix3d oblique() {
  return Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
}

const Corners l_shape = flat({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}});

TEST(Polygon, AConvexOneBecomesAFanFromItsFirstCorner) {
  Corners corners;
  for (int i = 0; i < 7; ++i) corners.emplace_back(std::cos(0.9 * i), std::sin(0.9 * i), 0);
  for (const TriangleSoup& soup :
       {expect_cut_rightly(corners), expect_cut_rightly(flat({{0, 0}, {4, 0}, {4, 1}, {0, 1}}))}) {
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(soup.faces.size()); ++i) {
      EXPECT_EQ(soup.faces[i], (Triangle{0, i + 1, i + 2}));
    }
  }
}

TEST(Polygon, ANonConvexQuadIsCutAlongItsInnerDiagonal) {
  const TriangleSoup soup = expect_cut_rightly(flat({{0, 0}, {2, 1}, {0, 2}, {1, 1}}));
  EXPECT_TRUE(soup.faces[0] == (Triangle{0, 1, 3}) || soup.faces[0] == (Triangle{3, 0, 1})) << soup.faces[0][0];
}

TEST(Polygon, AnLShapeIsCoveredOnceWhicheverCornerIsFirst) {
  for (std::size_t first = 0; first < l_shape.size(); ++first) {
    SCOPED_TRACE(first);
    expect_cut_rightly(rotated_to_start_at(l_shape, first));
  }
}

TEST(Polygon, AStarIsCoveredOnceWhicheverCornerIsFirst) {
  for (std::size_t first = 0; first < 10; ++first) {
    SCOPED_TRACE(first);
    expect_cut_rightly(rotated_to_start_at(star(5), first));
  }
}

TEST(Polygon, ACombOfManyTeethIsCoveredOnce) {
  const Corners corners = comb(500);
  EXPECT_EQ(area_vector(corners).norm(), 5 * 500 - 1);
  expect_cut_rightly(corners);
}

TEST(Polygon, ASpiralIsCoveredOnce) {
  Corners corners;
  for (int i = 0; i <= 300; ++i) {
    const double angle = 0.1 * i;
    corners.emplace_back((1 + 0.1 * angle) * std::cos(angle), (1 + 0.1 * angle) * std::sin(angle), 0);
  }
  for (int i = 300; i >= 0; --i) {
    const double angle = 0.1 * i;
    corners.emplace_back((0.8 + 0.1 * angle) * std::cos(angle), (0.8 + 0.1 * angle) * std::sin(angle), 0);
  }
  expect_cut_rightly(corners);
}

TEST(Polygon, CornersOnAStraightSideMakeNoTriangleWithoutArea) {
  // Fans from the first corners would have triangles without area here, though the outline is convex.
  const Corners square = flat({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {1.5, 3}, {0, 3}, {0, 1}});
  const Corners triangle = flat({{0, 0}, {1, 0}, {2, 0}, {0, 2}});
  for (const Corners& corners : {square, triangle}) {
    for (std::size_t first = 0; first < corners.size(); ++first) {
      SCOPED_TRACE(first);
      const Corners rotated = rotated_to_start_at(corners, first);
      EXPECT_GT(smallest_angle(expect_cut_rightly(rotated)), 0.1);
      Corners turned;
      for (const auto& p : rotated) turned.push_back(oblique() * p + Eigen::Vector3d(100, 20, -30));
      EXPECT_GT(smallest_angle(expect_cut_rightly(turned)), 0.1);
    }
  }
}

TEST(Polygon, SkylinesOfEqualAndUnequalHousesAreCoveredOnce) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    RandomStream stream("skylines", seed);
    const int houses = 3 + static_cast<int>(stream.uniform(0, 20));
    Corners corners;
    for (int i = 0; i <= houses; ++i) corners.emplace_back(i, 0, 0);
    double area = 0, height = 0;
    for (int i = houses; i > 0; --i) {
      const double next = 1 + std::floor(stream.uniform(0, 3));
      area += next;
      if (next != height) corners.emplace_back(i, next, 0);
      corners.emplace_back(i - 1, height = next, 0);
    }
    std::size_t first = static_cast<std::size_t>(stream.uniform(0, static_cast<double>(corners.size())));
    corners = rotated_to_start_at(corners, first);
    EXPECT_DOUBLE_EQ(area_vector(corners).norm(), area);
    expect_cut_rightly(corners);
    for (auto& p : corners) p = oblique() * p + Eigen::Vector3d(10, 20, 30);
    expect_cut_rightly(corners, 1e-9);
  }
}

TEST(Polygon, CornersThatAreStraightUpToTheDigitsOfAFileMakeNoSlivers) {
  // Rounded to six decimals, the corner is off its side by 3e-7.
  EXPECT_GT(smallest_angle(expect_cut_rightly(flat({{0, 0}, {1, 0.333333}, {3, 1}, {0, 4}}))), 0.1);
}

TEST(Polygon, AnObliquePlaneIsNoHindrance) {
  for (const Corners& corners : {l_shape, star(7), comb(20)}) {
    Corners turned;
    for (const auto& p : corners) turned.push_back(1e-3 * (oblique() * p) + Eigen::Vector3d(5, -7, 3));
    expect_cut_rightly(turned, 1e-9);
    std::reverse(turned.begin(), turned.end());
    expect_cut_rightly(turned, 1e-9);
  }
}

TEST(Polygon, SlightlyCurvedOnesAreCutAsSeenAlongTheirNormal) {
  Corners corners = star(6);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i][2] = 0.02 * std::sin(5.0 * static_cast<double>(i));
  expect_cut_rightly(corners);
  corners = l_shape;
  corners[3][2] = 0.1;
  expect_cut_rightly(corners);
}

/// The area that the mesh's triangles have together, and its boundary edges.
std::pair<double, int> area_and_boundary(const TriangleMesh& mesh) {
  std::pair<double, int> result{0, 0};
  for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h) {
    result.second += mesh.twin(h) < 0;
    if (h % 3 == 0)
      result.first += 0.5 * mesh.edge_length(h) * mesh.edge_length(h + 2) * std::sin(mesh.corner_angle(h));
  }
  return result;
}

TEST(Polygon, HolesThatABridgeJoinsToTheOutlineStayHoles) {
  // Squares with one square hole, and with two whose bridges start at the same corner; bridges are walked forth and
  // back.
  const std::string one = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 3 1 0\nv 3 3 0\nv 1 3 0\n";
  const std::string two = "v 0 0 0\nv 7 0 0\nv 7 7 0\nv 0 7 0\nv 1 2 0\nv 3 5 0\nv 1 6 0\nv 3 2 0\nv 6 1 0\nv 5 4 0\n";
  struct Case {
    std::string points;
    std::vector<int> corners;
    double area;
    int boundary;
  };
  for (Case c : {Case{one, {1, 2, 3, 4, 1, 5, 8, 7, 6, 5}, 12, 8},
                 Case{two, {1, 2, 3, 4, 1, 5, 7, 6, 5, 1, 8, 10, 9, 8}, 41, 10}}) {
    for (std::size_t first = 0; first < c.corners.size(); ++first) {
      SCOPED_TRACE(first);
      std::string face = "f";
      for (const int v : c.corners) face += " " + std::to_string(v);
      const TriangleMesh mesh = load_mesh(c.points + face + "\n");
      EXPECT_EQ(mesh.face_count(), static_cast<int>(c.corners.size()) - 2);
      const auto [area, boundary] = area_and_boundary(mesh);
      EXPECT_NEAR(area, c.area, 1e-12);
      EXPECT_EQ(boundary, c.boundary) << "bridges are no boundary";
      std::rotate(c.corners.begin(), c.corners.begin() + 1, c.corners.end());
    }
  }
}

TEST(Polygon, ANotchThatReachesTheOppositeCornerStaysOpen) {
  // Two triangles that meet in a corner only, walked as one outline.
  Corners corners = flat({{0, 0}, {6, -3}, {7, -1}, {0, 0}, {7, 1}, {6, 3}});
  for (int first = 0; first < 6; ++first) {
    SCOPED_TRACE(first);
    double area = 0;
    const TriangleSoup soup = read_mesh(obj_of(corners), MeshFormat::obj);
    for (const auto& [a, b, c] : soup.faces) {
      area += (soup.positions[b] - soup.positions[a]).cross(soup.positions[c] - soup.positions[a]).norm() / 2;
    }
    EXPECT_DOUBLE_EQ(area, 15);
    std::rotate(corners.begin(), corners.begin() + 1, corners.end());
  }
}

TEST(Polygon, EveryFormatAndVerticesThatFollowTheirFacesAreCutAlike) {
  const Corners corners = rotated_to_start_at(l_shape, 1);
  const std::vector<Triangle> expected = expect_cut_rightly(corners).faces;
  const std::string points = "3 0 0\n3 1 0\n1 1 0\n1 3 0\n0 3 0\n0 0 0\n";
  EXPECT_EQ(read_mesh("OFF\n6 1 0\n" + points + "6 0 1 2 3 4 5\n", MeshFormat::off).faces, expected);
  const std::string vertices = "element vertex 6\nproperty double x\nproperty double y\nproperty double z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string start = "ply\nformat ascii 1.0\n", end = "end_header\n", list = "6 0 1 2 3 4 5\n";
  EXPECT_EQ(read_mesh(start + vertices + faces + end + points + list, MeshFormat::ply).faces, expected);
  EXPECT_EQ(read_mesh(start + faces + vertices + end + list + points, MeshFormat::ply).faces, expected);
  const std::string obj = obj_of(corners);
  const std::size_t split = obj.find('f');
  EXPECT_EQ(read_mesh(obj.substr(split) + obj.substr(0, split), MeshFormat::obj).faces, expected);
}

TEST(Polygon, OnesThatCrossThemselvesAreRefusedByTheirNumberInTheFile) {
  const Corners bow_tie = flat({{0, 0}, {2, 2}, {2, 0}, {0, 1}});
  const Corners even_bow_tie = flat({{0, 0}, {1, 1}, {1, 0}, {0, 1}});
  Corners pentagram;
  for (int i = 0; i < 5; ++i)
    pentagram.emplace_back(std::cos(0.8 * i * std::numbers::pi), std::sin(0.8 * i * std::numbers::pi), 0);
  for (const Corners& corners : {bow_tie, even_bow_tie, pentagram}) {
    // A face of two corners and a sound one come before.
    std::string text = obj_of(corners);
    text.insert(text.find('f'), "f 1 2\nf 1 2 3\n");
    const Error error = expect_error("mesh.invalid_polygon", [&] { read_mesh(text, MeshFormat::obj); });
    ASSERT_EQ(testing::places(error), std::vector<std::string>{"face 2"});
    EXPECT_NE(error.details()[0].message.find(std::to_string(corners.size()) + " corners"), std::string::npos);
  }
}

TEST(Polygon, OnesWithoutAreaAreLeftToTheCheckOfTheFaces) {
  const Error error = expect_error("mesh.degenerate_face", [] {
    load_mesh(obj_of(flat({{0, 0}, {1, 0}, {3, 0}, {2, 0}})));
  });
  EXPECT_EQ(testing::places(error), (std::vector<std::string>{"face 0", "face 1"}));
  expect_error("mesh.non_finite", [] { load_mesh("v 0 0 0\nv nan 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"); });
  expect_error("mesh.index_out_of_range", [] { load_mesh("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3 9\n"); });
}

TEST(Polygon, ARepeatedCornerCostsOneTriangleWithoutAreaAndNoMore) {
  const TriangleSoup soup =
      read_mesh("v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 2 3 4 5 6\n", MeshFormat::obj);
  ASSERT_EQ(soup.faces.size(), 5u);
  double area = 0;
  int repeated = 0;
  for (const auto& [a, b, c] : soup.faces) {
    repeated += a == b || b == c || c == a;
    const double doubled = (soup.positions[b] - soup.positions[a]).cross(soup.positions[c] - soup.positions[a])[2];
    EXPECT_GE(doubled, 0);
    area += doubled / 2;
  }
  EXPECT_EQ(repeated, 1);
  EXPECT_DOUBLE_EQ(area, 5);
}

TEST(Polygon, TheNumberOfCornersIsLimitedWhereAFanWouldNotDo) {
  Corners corners = comb(1024);  // 4096 corners, the limit
  ASSERT_EQ(corners.size(), 4096u);
  expect_cut_rightly(corners);
  corners.insert(corners.begin() + 1, Eigen::Vector3d(0.5, -0.5, 0));
  const Error error = expect_error("mesh.invalid_polygon", [&] { read_mesh(obj_of(corners), MeshFormat::obj); });
  ASSERT_EQ(error.details().size(), 1u);
  EXPECT_NE(error.details()[0].message.find("4097 corners"), std::string::npos) << error.details()[0].message;
  EXPECT_NE(error.details()[0].message.find("the limit is 4096"), std::string::npos) << error.details()[0].message;
  Corners circle;
  for (int i = 0; i < 10'000; ++i)
    circle.emplace_back(std::cos(2e-4 * std::numbers::pi * i), std::sin(2e-4 * std::numbers::pi * i), 0);
  EXPECT_EQ(read_mesh(obj_of(circle), MeshFormat::obj).faces.size(), 9998u) << "a fan is right, whatever its size";
}

}  // namespace
}  // namespace supple::surface
