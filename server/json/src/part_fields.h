#pragma once

#include "fields.h"
#include "supple/json/json_writer.h"
#include "supple/json/limits.h"
#include "supple/json/part_requests.h"

// What requests and answers about parts and about their simulations have in common.
namespace supple::json {

/// Reads the fields of a part without its material, its SVG file and its deadline. The caller finishes them.
void read_part(Fields& fields, const Limits& limits, PartRequest& request);

/// The fields "size", "lower", "upper", "outline_area", "solid_area" and "relative_density".
void write_solid(JsonWriter& out, const tiling::Part& part);
/// The field "missing_solids".
void write_missing_solids(JsonWriter& out, const PartRequest& request, const tiling::Part& part);

}  // namespace supple::json
