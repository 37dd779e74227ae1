#pragma once

#include <string>
#include <string_view>

#include "fields.h"
#include "supple/tiling/family_definition.h"

namespace supple::json {

/// Reads a required field that is a family's id.
void read_family_id(Fields& fields, std::string_view name, std::string& out);

/// Reads the fields of a definition. The caller finishes them.
tiling::FamilyDefinition read_family_definition(Fields& fields);

}  // namespace supple::json
