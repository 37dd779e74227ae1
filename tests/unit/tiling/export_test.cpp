#include "supple/tiling/export.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "designs.h"
#include "polygon.h"
#include "support/expect_error.h"

namespace supple::tiling {
namespace {

using supple::testing::expect_error;
using supple::testing::places;
using testing::preset_structure;

std::size_t holes_per_cell(const Structure& structure) {
  std::size_t count = 0;
  for (const auto& holes : structure.holes) count += holes.size();
  return count;
}

std::vector<Polygon> polygons_of_svg(const std::string& svg) {
  const auto begin = svg.find(" d=\"") + 4;
  std::string path = svg.substr(begin, svg.find('"', begin) - begin);
  std::vector<Polygon> result;
  std::stringstream subpaths(path);
  for (std::string subpath; std::getline(subpaths, subpath);) {
    EXPECT_EQ(subpath.front(), 'M');
    EXPECT_EQ(subpath.back(), 'Z');
    for (char& c : subpath) {
      if (c == 'M' || c == 'L' || c == 'Z') c = ' ';
    }
    std::stringstream numbers(subpath);
    Polygon polygon;
    for (double x, y; numbers >> x >> y;) polygon.emplace_back(x, -y);
    result.push_back(polygon);
  }
  return result;
}

double signed_area(const std::vector<Polygon>& polygons) {
  double sum = 0;
  for (const Polygon& polygon : polygons) sum += area(polygon);
  return sum;
}

struct Pair {
  int code;
  std::string value;
};

std::vector<Pair> pairs_of_dxf(const std::string& dxf) {
  std::vector<Pair> result;
  std::stringstream lines(dxf);
  for (std::string code, value; std::getline(lines, code);) {
    EXPECT_TRUE(std::getline(lines, value));
    result.push_back({std::stoi(code), value});
  }
  return result;
}

std::vector<Polygon> polylines_of(const std::vector<Pair>& pairs) {
  std::vector<Polygon> result;
  bool open = false;
  for (const auto& [code, value] : pairs) {
    if (code == 0) {
      open = value == "LWPOLYLINE";
      if (open) result.emplace_back();
    } else if (open && code == 10) {
      result.back().emplace_back(std::stod(value), 0);
    } else if (open && code == 20) {
      result.back().back().y() = std::stod(value);
    }
  }
  return result;
}

using Vertex = std::array<float, 3>;

std::vector<std::array<Vertex, 3>> triangles_of_stl(const std::string& stl) {
  std::uint32_t count = 0;
  std::memcpy(&count, stl.data() + 80, sizeof count);
  EXPECT_EQ(stl.size(), 84 + 50 * static_cast<std::size_t>(count));
  std::vector<std::array<Vertex, 3>> result(count);
  for (std::uint32_t k = 0; k < count; ++k) std::memcpy(result[k].data(), stl.data() + 84 + 50 * k + 12, 36);
  return result;
}

double volume(const std::vector<std::array<Vertex, 3>>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const auto to_eigen = [](const Vertex& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
    Eigen::Matrix3d corners;
    corners << to_eigen(a), to_eigen(b), to_eigen(c);
    sum += corners.determinant() / 6;
  }
  return sum;
}

TEST(Export, TheSvgHasTheHolesOfItsCellsAndAFullRim) {
  for (const Family& family : families()) {
    const Structure structure = preset_structure(family.id.c_str());
    const std::vector<Polygon> polygons = polygons_of_svg(write_svg(structure, {.first = 3, .second = 2}));
    ASSERT_EQ(polygons.size(), 1 + 6 * holes_per_cell(structure)) << family.id;
    double holes = 0, outer = 0, rim = 0;
    for (const Polygon& polygon : polygons) {
      (area(polygon) < 0 ? holes : outer) += area(polygon);
      if (area(polygon) > 0) rim = perimeter(polygon);
    }
    EXPECT_NEAR(-holes, 6 * (structure.cell_area - structure.solid_area), 1e-3) << family.id;
    // The patch extends half a beam width beyond six cells; corners change its area little.
    const double expected = 6 * structure.cell_area + rim * structure.beam_width / 2;
    EXPECT_NEAR(outer, expected, 0.05 * rim * structure.beam_width) << family.id;
  }
}

TEST(Export, TheSvgsSizeIsTheSolidsInMillimetres) {
  const Structure structure = preset_structure("IH67");
  const std::string svg = write_svg(structure, {.first = 1, .second = 1});
  Eigen::Vector2d lower(0, 0), upper(0, 0);
  for (const Polygon& polygon : polygons_of_svg(svg)) {
    for (const Eigen::Vector2d& p : polygon) {
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
  }
  const auto number_after = [&](const std::string& name) {
    return std::stod(svg.substr(svg.find(name) + name.size()));
  };
  EXPECT_NEAR(number_after(" width=\""), upper.x() - lower.x(), 1e-4);
  EXPECT_NEAR(number_after(" height=\""), upper.y() - lower.y(), 1e-4);
  EXPECT_NE(svg.find("mm\" height"), std::string::npos);
  EXPECT_NE(svg.find("fill-rule=\"evenodd\""), std::string::npos);
  // A web page draws copies of a patch by these translations. They are in the file's coordinates, whose y points down.
  std::istringstream translations(svg.substr(svg.find("data-translations=\"") + 19));
  for (int k = 0; k < 2; ++k) {
    double x = 0, y = 0;
    translations >> x >> y;
    EXPECT_NEAR(x, structure.tiling.lattice(0, k), 1e-6);
    EXPECT_NEAR(-y, structure.tiling.lattice(1, k), 1e-6);
  }
}

TEST(Export, TheDxfHasTheSectionsOfR2000AndUniqueHandles) {
  const std::vector<Pair> pairs = pairs_of_dxf(write_dxf(preset_structure("IH22")));
  std::vector<std::string> sections;
  std::set<std::string> handles;
  int depth = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (pairs[k].code == 0 && pairs[k].value == "SECTION") {
      EXPECT_EQ(depth++, 0);
      ASSERT_EQ(pairs[k + 1].code, 2);
      sections.push_back(pairs[k + 1].value);
    }
    if (pairs[k].code == 0 && pairs[k].value == "ENDSEC") {
      EXPECT_EQ(--depth, 0);
    }
    // The handle after $HANDSEED is the next free one, which no object has.
    if (pairs[k].code == 5) {
      EXPECT_TRUE(handles.insert(pairs[k].value).second) << pairs[k].value;
    }
  }
  EXPECT_EQ(sections, (std::vector<std::string>{"HEADER", "CLASSES", "TABLES", "BLOCKS", "ENTITIES", "OBJECTS"}));
  for (const auto& [code, value] : pairs) {
    if (code == 330 && value != "0") {
      EXPECT_TRUE(handles.contains(value)) << "owner " << value;
    }
  }
  EXPECT_EQ(pairs.back().value, "EOF");
  EXPECT_EQ(pairs[3].value, "AC1015");
}

TEST(Export, TheDxfsPolylinesAreClosedAndThoseOfTheSvg) {
  const Structure structure = preset_structure("IH28");
  const std::string dxf = write_dxf(structure);
  const std::vector<Pair> pairs = pairs_of_dxf(dxf);
  const std::vector<Polygon> polylines = polylines_of(pairs), paths = polygons_of_svg(write_svg(structure));
  ASSERT_EQ(polylines.size(), paths.size());
  for (std::size_t k = 0; k < paths.size(); ++k) {
    ASSERT_EQ(polylines[k].size(), paths[k].size());
    for (std::size_t j = 0; j < paths[k].size(); ++j) EXPECT_LT((polylines[k][j] - paths[k][j]).norm(), 2e-5);
  }
  for (std::size_t k = 0, line = 0; k < pairs.size(); ++k) {
    if (pairs[k].code != 0 || pairs[k].value != "LWPOLYLINE") continue;
    const auto value_of = [&](int code) {
      for (std::size_t j = k + 1; pairs[j].code != 0; ++j) {
        if (pairs[j].code == code) return pairs[j].value;
      }
      return std::string();
    };
    EXPECT_EQ(value_of(70), "1");
    EXPECT_EQ(value_of(90), std::to_string(polylines[line++].size()));
  }
}

TEST(Export, TheStlIsClosedOrientedAndHasTheSolidsVolume) {
  for (const Family& family : families()) {
    const Structure structure = preset_structure(family.id.c_str());
    const ExportOptions options = {.first = 2, .second = 2, .height = 1.5};
    const auto triangles = triangles_of_stl(write_stl(structure, options));
    std::map<std::pair<Vertex, Vertex>, int> edges;
    for (const auto& triangle : triangles) {
      for (int k = 0; k < 3; ++k) ++edges[{triangle[k], triangle[(k + 1) % 3]}];
    }
    for (const auto& [edge, uses] : edges) {
      ASSERT_EQ(uses, 1) << family.id;
      ASSERT_EQ(edges.count({edge.second, edge.first}), 1u) << family.id;
    }
    const double solid = signed_area(polygons_of_svg(write_svg(structure, options)));
    EXPECT_NEAR(volume(triangles), solid * options.height, 1e-4 * solid) << family.id;
  }
}

TEST(Export, StructuresAtTheEdgeOfTheirFamilyAreWrittenToo) {
  for (const double p : {0.0, 1e-6, 0.0428, 0.9572, 1.0}) {
    const Structure structure = make_structure(family("square"), std::vector{p});
    const double solid = signed_area(polygons_of_svg(write_svg(structure)));
    EXPECT_NEAR(volume(triangles_of_stl(write_stl(structure))), solid, 1e-4 * solid) << p;
  }
  const Structure crossing = make_structure(family("IH01"), std::vector{0.18020891, 0.55065870, 0.09055190, 0.778137});
  const double solid = signed_area(polygons_of_svg(write_svg(crossing)));
  EXPECT_NEAR(volume(triangles_of_stl(write_stl(crossing))), solid, 1e-4 * solid);
}

TEST(Export, PatchesOfTilesThatCrossThemselvesAreInOnePiece) {
  RandomStream random("tiling.crumbs", 7);
  const Family& type = family("IH01");
  std::vector<std::vector<double>> designs = {{0.2346258869, 0.7291153145, 0.05125551419, 0.4096083779}};
  while (designs.size() < 40) designs.push_back(testing::random_parameters(type, random));
  int crossing = 0;
  for (const std::vector<double>& parameters : designs) {
    Structure structure;
    try {
      structure = make_structure(type, parameters);
    } catch (const Error&) {
      continue;
    }
    crossing += structure.tiles_cross;
    int pieces = 0;
    for (const Polygon& polygon : polygons_of_svg(write_svg(structure, {.first = 3, .second = 3})))
      pieces += area(polygon) > 0;
    EXPECT_EQ(pieces, 1) << parameters[0] << " " << parameters[1] << " " << parameters[2] << " " << parameters[3];
  }
  EXPECT_GT(crossing, 3);
}

TEST(Export, OptionsOutOfRangeAreNamedWithTheirLimits) {
  const Structure structure = preset_structure("IH01");
  const auto refused = [&](const ExportOptions& options) {
    return expect_error("tiling.export_option", [&] { write_svg(structure, options); });
  };
  const Error error = refused({.first = 0, .second = 101, .height = -1});
  EXPECT_EQ(places(error), (std::vector<std::string>{"first", "second", "height"}));
  EXPECT_NE(error.details()[1].message.find("from 1 to 100"), std::string::npos);
  EXPECT_EQ(places(refused({.height = std::numeric_limits<double>::quiet_NaN()})), std::vector<std::string>{"height"});
  expect_error("tiling.export_option", [&] { write_dxf(structure, {.height = 1e9}); });
  expect_error("tiling.export_option", [&] { write_stl(structure, {.first = -1}); });
}

}  // namespace
}  // namespace supple::tiling
