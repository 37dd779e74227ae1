#pragma once

#include <filesystem>
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
  std::vector<std::string> warnings;  ///< e.g. about polygons that were triangulated, or elements that were skipped
};

/// The format that the first bytes show: "ply\n", "OFF", "solid", or binary STL by its size; otherwise OBJ.
MeshFormat detect_format(std::string_view bytes);

/// Reads a mesh file.
///
/// - OBJ: v, and f with v/vt/vn and negative indices.
/// - OFF: with counts and comments; colours (COFF) and normals (NOFF) are skipped.
/// - PLY 1.0: ascii, binary little and big endian, any scalar types, list faces; other elements are skipped.
/// - STL: ascii and binary; vertices with equal coordinates are merged.
///
/// The triangles of a polygon take its place in the order of faces. Convex polygons become fans from their first
/// corner, others are triangulated by clipping ears in the projection along their normal. Reading never passes the end,
/// whatever the bytes are, and reserves no more memory than the bytes could fill. O(bytes), and O(n^2) for each polygon
/// of n corners that no fan covers.
///
/// Throws "mesh.malformed" with "line 12" or "byte 84" and what was expected, and "mesh.too_large" with the limit and
/// the value. Throws "mesh.invalid_polygon" if a polygon crosses itself, or if a fan does not cover it and it has more
/// than 4096 corners. Details name faces as the file counts them ("face 17", from 0, skipped ones included). Ends
/// within some 50 ms after a stop is requested.
TriangleSoup read_mesh(std::string_view bytes, MeshFormat format, const MeshLimits& limits = {},
                       const Execution& execution = {});

/// Reads a mesh of the detected format (read_mesh) and builds it (TriangleMesh::build). Its warnings are those of both.
TriangleMesh load_mesh(std::string_view bytes, const MeshLimits& limits = {}, const Execution& execution = {});

/// Reads and builds the mesh in a file. Throws "file.unreadable" if the file cannot be read, and what load_mesh throws.
TriangleMesh load_mesh_file(const std::filesystem::path& path, const MeshLimits& limits = {},
                            const Execution& execution = {});

std::string write_obj(const TriangleMesh& mesh, const Execution& execution = {});
/// Binary little-endian PLY with double coordinates and int32 indices. It is the canonical form: equal meshes give
/// equal bytes.
std::string write_ply(const TriangleMesh& mesh, const Execution& execution = {});

}  // namespace supple::surface
