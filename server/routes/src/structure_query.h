#pragma once

#include <optional>
#include <vector>

#include "supple/http/message.h"
#include "supple/json/limits.h"
#include "supple/tiling/export.h"

// What a link to a structure's file asks for.
namespace supple::routes {

/// A kind of file of a structure: its media type, and what writes it.
struct StructureFormat {
  std::string_view media_type;
  std::string (*write)(const tiling::Structure&, const tiling::ExportOptions&, const Execution&);
};

struct StructureQuery {
  std::optional<std::vector<double>> parameters;   ///< the family's default without them
  double beam_width = tiling::printed_beam_width;  ///< mm
  tiling::ExportOptions files;
  StructureFormat format{"image/svg+xml", tiling::write_svg};
};

/// Reads the query parameters `parameters`, `beam_width`, `cells`, `format` and `height`. Throws
/// "request.invalid_parameter", which names each parameter at fault, also those that do not exist.
StructureQuery read_structure_query(const http::Request& request, const json::Limits& limits);

}  // namespace supple::routes
