#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "supple/json/limits.h"

namespace supple::json {

using Document = nlohmann::json;

/// Parses a body from a stranger in one pass, counting as it goes. Throws "request.not_utf8",
/// "request.malformed_json" (with the byte, and for repeated keys), "request.too_deep", "request.too_many_values".
Document parse_document(std::string_view text, const Limits& limits);

}  // namespace supple::json
