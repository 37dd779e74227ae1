#pragma once

#include <optional>
#include <vector>

#include "supple/http/message.h"
#include "supple/json/limits.h"
#include "supple/tiling/export.h"

// The query of a link to a structure's file.
namespace supple::routes {

/// A kind of file of a structure: its media type, its name in links, and what writes it.
struct StructureFormat {
  std::string_view media_type;
  std::string_view ending;
  std::string (*write)(const tiling::Structure&, const tiling::ExportOptions&, const Execution&);
};
/// Links with "dxf" get the first one that has this name.
inline constexpr StructureFormat structure_formats[] = {{"image/svg+xml", "svg", tiling::write_svg},
                                                        {"image/vnd.dxf", "dxf", tiling::write_dxf},
                                                        {"application/dxf", "dxf", tiling::write_dxf},
                                                        {"model/stl", "stl", tiling::write_stl}};

struct StructureQuery {
  std::optional<std::vector<double>> parameters;   ///< the family's default without them
  double beam_width = tiling::printed_beam_width;  ///< mm
  tiling::ExportOptions files;
  StructureFormat format = structure_formats[0];
};

/// Reads the query parameters `parameters`, `beam_width`, `cells`, `format` and `height`. Throws
/// "request.invalid_parameter", which names each parameter at fault, also those that do not exist.
StructureQuery read_structure_query(const http::Request& request, const json::Limits& limits);

}  // namespace supple::routes
