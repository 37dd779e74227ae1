#include "mesh_reading.h"

#include <algorithm>
#include <utility>

#include "mesh_faults.h"
#include "polygon_cutter.h"
#include "supple/base/error.h"
#include "supple/surface/mesh_error.h"

namespace supple::surface {
namespace {

[[noreturn]] void throw_too_large(std::int64_t count, std::int64_t limit, const std::string& what) {
  const std::string over = std::to_string(count) + " " + what + ", the limit is " + std::to_string(limit);
  throw MeshSizeError("mesh.too_large", "The mesh has at least " + over + ".", {{what, over}});
}

void check_limit(std::int64_t count, std::int64_t limit, const char* what) {
  if (count > limit) throw_too_large(count, limit, what);
}

/// Whether the bytes are text in UTF-16 without a byte order mark: printable characters alternate with zeros.
bool looks_like_utf16(std::string_view bytes, std::size_t first_letter) {
  constexpr std::size_t checked_bytes = 32;
  if (bytes.size() < checked_bytes) return false;
  for (std::size_t i = 0; i < checked_bytes; ++i) {
    const char c = bytes[i];
    const bool printable = (c >= ' ' && c <= '~') || c == '\t' || c == '\r' || c == '\n';
    if (i % 2 == first_letter ? !printable : c != '\0') return false;
  }
  return true;
}

}  // namespace

void refuse_foreign_files(std::string_view bytes) {
  using namespace std::string_view_literals;
  struct Row {
    std::string_view start;
    std::string_view kind;
  };
  constexpr std::string_view utf16 = "text in UTF-16; save it as UTF-8", utf32 = "text in UTF-32; save it as UTF-8";
  constexpr Row table[] = {{"\xFF\xFE\0\0"sv, utf32},
                           {"\0\0\xFE\xFF"sv, utf32},
                           {"\xFF\xFE"sv, utf16},
                           {"\xFE\xFF"sv, utf16},
                           {"PK\x03\x04"sv, "a ZIP archive, such as 3MF; export OBJ, OFF, PLY or STL"},
                           {"\x1F\x8B"sv, "compressed by gzip; unpack it"},
                           {"glTF"sv, "glTF; export OBJ, OFF, PLY or STL"},
                           {"ISO-10303-21"sv, "a STEP file, which holds no mesh; export OBJ, OFF, PLY or STL"},
                           {"Kaydara FBX"sv, "FBX; export OBJ, OFF, PLY or STL"},
                           {"<?xml"sv, "XML; export OBJ, OFF, PLY or STL"},
                           {"<!DOCTYPE"sv, "a web page, not a mesh"},
                           {"<html"sv, "a web page, not a mesh"},
                           {"version https://git-lfs"sv, "a pointer of Git LFS, not the file itself"},
                           {"MeshVersionFormatted"sv, "a file of MEDIT; export OBJ, OFF, PLY or STL"},
                           {"$MeshFormat"sv, "a file of gmsh; export OBJ, OFF, PLY or STL"},
                           {"#VRML"sv, "VRML; export OBJ, OFF, PLY or STL"},
                           {"# vtk DataFile"sv, "a VTK file; export OBJ, OFF, PLY or STL"}};
  const auto refuse = [](std::string_view kind) { throw_malformed_byte(0, "the file is " + std::string(kind)); };
  for (const Row& row : table)
    if (bytes.starts_with(row.start)) refuse(row.kind);
  if (looks_like_utf16(bytes, 0) || looks_like_utf16(bytes, 1)) refuse(utf16);
}

void SoupBuilder::check_announced(std::int64_t vertices, std::int64_t faces) const {
  check_limit(vertices, limits_.vertices, "vertices");
  check_limit(faces, limits_.faces, "faces");
}

void SoupBuilder::reserve(std::size_t vertices, std::size_t faces) {
  soup_.positions.reserve(vertices);
  soup_.faces.reserve(faces);
}

void SoupBuilder::add_vertex(const Eigen::Vector3d& p) {
  pace_.check();
  check_limit(vertex_count() + 1, limits_.vertices, "vertices");
  soup_.positions.push_back(p);
}

void SoupBuilder::add_polygon(std::span<const std::int32_t> corners) {
  pace_.check();
  const std::int64_t number = polygons_++;
  if (corners.size() < 3) {
    ++skipped_polygons_;
    return;
  }
  if (corners.size() > 3) larger_polygons_.push_back({number, soup_.faces.size(), corners.size()});
  check_limit(static_cast<std::int64_t>(soup_.faces.size() + corners.size() - 2), limits_.faces, "faces");
  for (std::size_t i = 2; i < corners.size(); ++i) soup_.faces.push_back({corners[0], corners[i - 1], corners[i]});
}

void SoupBuilder::cut_polygons() {
  PolygonCutter cutter;
  FaultList faults;
  std::vector<std::int32_t> corners;
  std::vector<Eigen::Vector3d> positions;
  std::vector<Triangle> triangles;
  for (const Polygon& polygon : larger_polygons_) {
    execution_.cancellation.throw_if_requested();
    const std::span<Triangle> fan(soup_.faces.data() + polygon.first_triangle, polygon.corners - 2);
    corners.assign({fan[0][0], fan[0][1]});
    for (const Triangle& triangle : fan) corners.push_back(triangle[2]);
    // The check of the mesh reports faces whose vertices do not exist.
    const auto exists = [&](std::int32_t v) { return v >= 0 && v < vertex_count(); };
    if (!std::all_of(corners.begin(), corners.end(), exists)) continue;
    positions.clear();
    for (const std::int32_t v : corners) positions.push_back(soup_.positions[v]);
    triangles.resize(fan.size());
    const PolygonCutter::Outcome outcome = cutter.cut(positions, triangles);
    if (outcome != PolygonCutter::Outcome::cut) {
      faults.add([&]() -> Error::Detail {
        const std::string size = "has " + std::to_string(polygon.corners) + " corners and ";
        return {name_of_face(polygon.number),
                size + (outcome == PolygonCutter::Outcome::crosses_itself
                            ? "crosses itself"
                            : "is not convex; the limit is " + std::to_string(PolygonCutter::max_corners))};
      });
      continue;
    }
    for (std::size_t i = 0; i < fan.size(); ++i) {
      for (int j = 0; j < 3; ++j) fan[i][j] = corners[triangles[i][j]];
    }
  }
  faults.throw_if_any("mesh.invalid_polygon", "polygon cannot be cut into triangles",
                      "polygons cannot be cut into triangles");
}

TriangleSoup SoupBuilder::finish() && {
  cut_polygons();
  if (const std::size_t cut = larger_polygons_.size(); cut > 0) {
    soup_.warnings.push_back(std::to_string(cut) + (cut == 1 ? " polygon was" : " polygons were") +
                             " cut into triangles.");
  }
  if (skipped_polygons_ > 0) {
    soup_.warnings.push_back(
        std::to_string(skipped_polygons_) +
        (skipped_polygons_ == 1 ? " face of fewer than three corners was" : " faces of fewer than three corners were") +
        " left out.");
  }
  return std::move(soup_);
}

std::size_t plausible_count(std::int64_t announced, std::size_t bytes, std::size_t bytes_per_element) {
  return std::min(static_cast<std::size_t>(std::max<std::int64_t>(announced, 0)), bytes / bytes_per_element + 1);
}

}  // namespace supple::surface
