#pragma once

#include <string>
#include <string_view>

#include "fields.h"

namespace supple::json {

/// Reads a required field that is a family's id.
void read_family_id(Fields& fields, std::string_view name, std::string& out);

}  // namespace supple::json
