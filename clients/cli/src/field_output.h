#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace supple::cli {

/// The positions and faces of a mesh.
struct Geometry {
  std::vector<std::array<double, 3>> positions;
  std::vector<std::array<std::int32_t, 3>> faces;
};

/// The values of an octet-stream answer, one for each vertex; infinity for an unreached one, for which the server sends
/// -1. Throws Failure(server_error) if the length is no multiple of 8.
std::vector<double> decode_field(const std::string& bytes);

/// The mesh in the server's canonical file: binary little-endian PLY with double x, y, z and lists of int indices, and
/// nothing else. Throws Failure(server_error) if the bytes are something else.
Geometry decode_geometry(const std::string& ply);

/// CSV with the titles "vertex,distance" and a line for each vertex; an unreachable one has no distance.
std::string field_as_csv(const std::vector<double>& distances);

/// Binary PLY with float64 coordinates, 8-bit colours and the distances as the vertex property "quality" (float64).
/// Colours run from dark blue at 0 to yellow at the largest distance. Every second one of `bands` bands is darkened,
/// which shows level lines (0 bands for none). Unreachable vertices are grey.
std::string field_as_ply(const Geometry& mesh, const std::vector<double>& distances, int bands);

}  // namespace supple::cli
