#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/json/answers.h"
#include "supple/json/limits.h"
#include "supple/json/name_table.h"
#include "supple/tiling/definition_check.h"
#include "supple/tiling/tile_drawing.h"

/// The check of a family's definition as request and answer; the request is read like those of requests.h.
namespace supple::json {

inline constexpr auto flaw_names = names_of<tiling::DefinitionFlaw>({{tiling::DefinitionFlaw::field, "field"},
                                                                     {tiling::DefinitionFlaw::unused, "unused"},
                                                                     {tiling::DefinitionFlaw::too_large, "too_large"},
                                                                     {tiling::DefinitionFlaw::gap, "gap"},
                                                                     {tiling::DefinitionFlaw::overlap, "overlap"},
                                                                     {tiling::DefinitionFlaw::unmatched, "unmatched"},
                                                                     {tiling::DefinitionFlaw::crossing, "crossing"},
                                                                     {tiling::DefinitionFlaw::sliver, "sliver"}});

struct FamilyCheckRequest {
  tiling::FamilyDefinition definition;
  std::optional<std::vector<double>> parameters;  ///< at which the tiling is drawn; none: the defaults
  double deadline = 0;                            ///< seconds; set also where the request leaves it out
};
FamilyCheckRequest parse_family_check(std::string_view body, const Limits& limits,
                                      const CancellationToken& cancellation = {});

/// A family that is to be added: a definition, or the drawing of a tile.
struct FamilyUpload {
  std::optional<tiling::FamilyDefinition> definition;
  std::string svg;              ///< text of the drawing; empty where there is a definition
  tiling::TileDrawing drawing;  ///< what is said about the drawing, without its outline
  double deadline = 0;          ///< seconds; set also where the request leaves it out
};
FamilyUpload parse_family_upload(std::string_view body, const Limits& limits,
                                 const CancellationToken& cancellation = {});

/// The answer to an upload; `family` is that of `write_family`.
std::string write_added_family(const std::string& family, const std::vector<tiling::DefinitionFinding>& warnings);

/// The tiling at the parameters of a request.
struct DrawnTiling {
  std::vector<double> parameters;
  double beam_width = 0;  ///< tiling units
  tiling::Tiling tiling;
};

/// `drawn` is null where a fault of the definition's fields leaves nothing to draw.
std::string write_family_check(const tiling::DefinitionReport& report, const DrawnTiling* drawn, const Bill& bill);

}  // namespace supple::json
