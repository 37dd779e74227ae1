#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// Reads a surface point as typed: "v17" is a vertex, "12:0.2,0.3,0.5" a face and its three barycentric coordinates,
/// "12:0.2,0.3" the same with the third coordinate left to complete the sum of 1. Returns the point as the wire has it.
/// Throws Failure(usage) that quotes the text and says what was expected.
nlohmann::json parse_surface_point(const std::string& text);

/// The inverse of parse_surface_point, for people: "vertex 17" or "face 12 (0.2, 0.3, 0.5)".
std::string describe_surface_point(const nlohmann::json& point);

}  // namespace supple::cli
