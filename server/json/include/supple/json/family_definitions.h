#pragma once

#include <string>
#include <string_view>

#include "supple/base/cancellation.h"
#include "supple/json/json_writer.h"
#include "supple/json/limits.h"
#include "supple/tiling/family_definition.h"

/// Definitions of families as JSON: what a family's file holds, and what requests and answers say of one (schema
/// `FamilyDefinition` of the contract).
namespace supple::json {

/// Reads a definition. A definition that names an isohedral type gets the tile of the type. Throws what requests.h
/// says. Whether the tile tiles the plane is for `tiling::check_definition` to say.
tiling::FamilyDefinition parse_family_definition(std::string_view body, const Limits& limits,
                                                 const CancellationToken& cancellation = {});

/// Writes a definition, which `parse_family_definition` reads back as it was.
void write_family_definition(JsonWriter& out, const tiling::FamilyDefinition& definition);
std::string write_family_definition(const tiling::FamilyDefinition& definition);

/// The table of the 81 isohedral types.
std::string write_isohedral_types();

}  // namespace supple::json
