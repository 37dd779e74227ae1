#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// A place of a weave as the wire has it: "c12" is a crossing, "3@5.2" lies 5.2 mm along strand 3, "3:start" and
/// "3:end" are its ends, and "0,0,10,40" is the box of everything between two corners. Throws Failure(usage).
nlohmann::json parse_place(const std::string& text);

/// "PLACE=x,y" or "PLACE=x,y,z": a place and a vector. Throws Failure(usage), which says what the vector is.
struct PlacedVector {
  nlohmann::json place;
  nlohmann::json vector;
};
PlacedVector parse_placed_vector(const std::string& text, const char* what);

}  // namespace supple::cli
