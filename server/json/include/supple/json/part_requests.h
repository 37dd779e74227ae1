#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/json/answers.h"
#include "supple/json/limits.h"
#include "supple/json/structure_requests.h"
#include "supple/tiling/part.h"

/// Parts, as requests and answers; read like those of requests.h. Whether outlines and structures make sense is not
/// checked here.
namespace supple::json {

inline constexpr auto rim_names =
    names_of<tiling::Rim>({{tiling::Rim::clipped, "clipped"}, {tiling::Rim::whole, "whole"}});

/// A structure that fills an area.
struct FillingSpec {
  StructureSpec structure;
  double beam_width = tiling::printed_beam_width;
  double orientation = 0;
  /// The direction of its design (rad) that is to lie along the axis of the part; none where the structure is not
  /// turned.
  std::optional<double> direction;
};

struct PartRegionSpec {
  std::string name;
  tiling::Polygon outline;
  FillingSpec filling;
};

struct PartRequest {
  tiling::PartDesign design;  ///< without its fillings and regions
  FillingSpec filling;
  std::vector<PartRegionSpec> regions;
  /// The direction (rad) along which the part is loaded: that of a coupon or a block, or the one that the request
  /// gives.
  std::optional<double> axis;
  std::vector<std::string> solid_names;  ///< names of the design's solids: "lower_grip", "upper_plate"
  double material_density = 1.2;         ///< g/cm^3
  bool svg = false;
  double deadline = 0;  ///< seconds; set also where the request leaves it out

  /// The orientation in the part of a structure that fills it or a region of it, rad.
  double orientation_in_part(const FillingSpec& spec) const;
  /// The direction of the design (rad) that lies along the load; none where the part has no axis.
  std::optional<double> tested_direction() const;
};
PartRequest parse_part(std::string_view body, const Limits& limits, const CancellationToken& cancellation = {});

/// Message about a part that is not all that was asked for, with remedies; empty where it is.
std::string part_message(const PartRequest& request, const tiling::Part& part);

std::string write_part(const PartRequest& request, const tiling::Part& part, const std::string* svg, const Bill& bill);

}  // namespace supple::json
