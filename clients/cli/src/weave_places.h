#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "units.h"

namespace supple::cli {

/// A place of a weave as JSON: "c12" is a crossing, "3@5.2" the point 5.2 mm along strand 3, "3:start" and "3:end" are
/// its ends, and "0,0,10,40" is everything in the box between two corners. Throws Failure(usage).
nlohmann::json parse_place(const std::string& text);

/// A place and a vector.
struct PlacedVector {
  nlohmann::json place;
  nlohmann::json vector;
};
/// A place and a vector from "PLACE=x,y" or "PLACE=x,y,z". Throws Failure(usage), which names the vector as `what`.
/// Its components may have units of the dimension.
PlacedVector parse_placed_vector(const std::string& text, const char* what, Dimension dimension);

}  // namespace supple::cli
