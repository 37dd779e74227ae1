#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/design/family_atlas.h"
#include "supple/json/answers.h"
#include "supple/json/limits.h"
#include "supple/json/name_table.h"

/// The atlas of a family as request, answer and file; the request is read like those of requests.h.
namespace supple::json {

inline constexpr auto atlas_place_names = names_of<design::AtlasPlace>({{design::AtlasPlace::good, "good"},
                                                                        {design::AtlasPlace::sliver, "sliver"},
                                                                        {design::AtlasPlace::crossing, "crossing"},
                                                                        {design::AtlasPlace::closed, "closed"},
                                                                        {design::AtlasPlace::unsolved, "unsolved"}});

/// One of `family`, `isohedral_type` and `definition` is set.
struct FamilyAtlasRequest {
  std::string family;      ///< id of a family that comes with the server, or that a client has added
  int isohedral_type = 0;  ///< number of a type, whose atlas is of design::atlas_definition
  std::optional<tiling::FamilyDefinition> definition;
  design::AtlasOptions options;   ///< all but `crossings`, whose default depends on what the atlas is of
  std::optional<bool> crossings;  ///< none: the default
  bool recompute = false;         ///< even if the atlas is kept
  double deadline = 0;            ///< seconds; set also where the request leaves it out
};
FamilyAtlasRequest parse_family_atlas_request(std::string_view body, const Limits& limits,
                                              const CancellationToken& cancellation = {});

/// An atlas with what it is of and what it cost: what a file keeps.
struct AtlasRecord {
  design::FamilyAtlas atlas;
  std::shared_ptr<const tiling::FamilyDefinition> definition;  ///< null for a family that is code
  std::string effects;                                         ///< JSON: the effects of its computation
  std::string cost;                                            ///< JSON: what its computation cost
};

AtlasRecord make_atlas_record(design::FamilyAtlas atlas, std::shared_ptr<const tiling::FamilyDefinition> definition,
                              const Bill& bill);

/// What the atlas is compared with.
struct ComparedAtlas {
  design::AtlasComparison comparison;
  std::vector<std::string> families;
};

/// The answer, or without a comparison the file. `is_kept` says whether it was computed before this request.
std::string write_family_atlas(const AtlasRecord& record, const ComparedAtlas* compared, bool is_kept);

/// The record in a file that the function above has written. None if the text is no such file, or is of another
/// definition than `definition`, so that it no longer holds.
std::optional<AtlasRecord> read_family_atlas(std::string_view text,
                                             std::shared_ptr<const tiling::FamilyDefinition> definition);

}  // namespace supple::json
