#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// A surface point from its text, as JSON. "v17" is a vertex; "12:0.2,0.3,0.5" a face and its three barycentric
/// coordinates; "12:0.2,0.3" the same, where the third coordinate makes the sum 1; "@1,2.5,-3" the point of the surface
/// that is nearest to a point in space. Throws Failure(usage) that quotes the text and says what was expected.
nlohmann::json parse_surface_point(const std::string& text);

/// The description of a surface point for people: "vertex 17", "face 12 (0.2, 0.3, 0.5)" or "the point nearest to
/// (1, 2.5, -3)".
std::string describe_surface_point(const nlohmann::json& point);

/// If a request has points in space, prints their nearest points on the surface and their distances from it.
void print_points_in_space(const nlohmann::json& answer);

}  // namespace supple::cli
