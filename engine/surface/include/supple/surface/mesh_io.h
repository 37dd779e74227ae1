#pragma once

#include <string>
#include <string_view>

#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

enum class MeshFormat { obj, off, ply, stl };

struct MeshLimits {
  std::int64_t vertices = 20'000'000;
  std::int64_t faces = 40'000'000;
};

/// Vertices and faces as read from a file, before any check of the connectivity.
struct TriangleSoup {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Triangle> faces;
  std::vector<std::string> warnings;  ///< for example about polygons that were cut, or elements that were skipped
};

/// The format that the first bytes show ("ply\n", "OFF", "solid"/binary STL by its size, otherwise OBJ).
MeshFormat detect_format(std::string_view bytes);

/// Reads OBJ (v, f with v/vt/vn and negative indices), OFF (with counts, comments, COFF/NOFF colours skipped), PLY 1.0
/// (ascii, binary little and big endian; any scalar types; list faces; other elements skipped) or STL (ascii and
/// binary; vertices with equal coordinates are merged). Polygons are cut into triangles where they stand: convex ones
/// into fans from their first corner, others by clipping ears as seen along their normal. Never reads past the end
/// whatever the bytes say, and reserves no more memory than the bytes could fill. O(bytes), and O(n^2) for each polygon
/// of n corners that no fan covers.
///
/// Throws "mesh.malformed" with "line 12" or "byte 84" and what was expected, "mesh.too_large" with the limit and the
/// value, "mesh.invalid_polygon" with the numbers that the faces have in the file ("face 17", counted from 0, skipped
/// ones included) where a polygon crosses itself, or is not covered by a fan and has more than 4096 corners. Stops
/// within some 50 ms of a request to.
TriangleSoup read_mesh(std::string_view bytes, MeshFormat format, const MeshLimits& limits = {},
                       const Execution& execution = {});

/// Reads a mesh of the detected format (read_mesh) and builds it (TriangleMesh::build), with the warnings of both.
TriangleMesh load_mesh(std::string_view bytes, const MeshLimits& limits = {}, const Execution& execution = {});

std::string write_obj(const TriangleMesh& mesh, const Execution& execution = {});
/// Binary little-endian PLY with double coordinates and int32 indices: the canonical form, equal for equal meshes.
std::string write_ply(const TriangleMesh& mesh, const Execution& execution = {});

}  // namespace supple::surface
