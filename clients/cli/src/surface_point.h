#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// Reads a surface point as typed: "v17" is a vertex, "12:0.2,0.3,0.5" a face and its three barycentric coordinates,
/// "12:0.2,0.3" the same with the third coordinate left to complete the sum of 1, "@1,2.5,-3" the point of the surface
/// that is nearest to a point in space. Returns the point as the wire has it. Throws Failure(usage) that quotes the
/// text and says what was expected.
nlohmann::json parse_surface_point(const std::string& text);

/// The inverse of parse_surface_point, for people: "vertex 17", "face 12 (0.2, 0.3, 0.5)" or "the point nearest
/// to (1, 2.5, -3)".
std::string describe_surface_point(const nlohmann::json& point);

/// Prints where the points in space of a request lie on the surface and how far from it, if its answer tells of any.
void print_points_in_space(const nlohmann::json& answer);

}  // namespace supple::cli
