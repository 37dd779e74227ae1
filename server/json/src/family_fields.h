#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fields.h"
#include "supple/json/json_writer.h"
#include "supple/tiling/definition_check.h"

namespace supple::json {

/// Reads a required field that is a family's id.
void read_family_id(Fields& fields, std::string_view name, std::string& out);

/// Reads the fields of a definition. The caller finishes them.
tiling::FamilyDefinition read_family_definition(Fields& fields);

/// A field with what a check of a definition found.
void write_findings(JsonWriter& out, std::string_view name, const std::vector<tiling::DefinitionFinding>& findings);

}  // namespace supple::json
