#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace supple::cli {

/// A mesh as far as drawing needs it.
struct Geometry {
  std::vector<std::array<double, 3>> positions;
  std::vector<std::array<std::int32_t, 3>> faces;
};

/// The values of an octet-stream answer, one for each vertex; infinity where the server sends -1, which means
/// unreached. Throws Failure(server_error) where the length is no multiple of 8.
std::vector<double> decode_field(const std::string& bytes);

/// The mesh of the server's canonical file (binary little-endian PLY with double x, y, z and lists of int indices,
/// nothing else). Throws Failure(server_error) where the bytes are something else.
Geometry decode_geometry(const std::string& ply);

/// "vertex,distance" and one line for each vertex; the distance is empty where the vertex is unreachable.
std::string field_as_csv(const std::vector<double>& distances);

/// Binary PLY with float64 coordinates, 8-bit colours and the distances as the vertex property "quality" (float64).
/// Colours run from dark blue at 0 to yellow at the largest distance, lightened and darkened in `bands` bands that show
/// the level lines (0 for none); unreachable vertices are grey.
std::string field_as_ply(const Geometry& mesh, const std::vector<double>& distances, int bands);

}  // namespace supple::cli
