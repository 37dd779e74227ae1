#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/json/answers.h"
#include "supple/json/limits.h"
#include "supple/json/name_table.h"
#include "supple/json/part_requests.h"
#include "supple/microscale/part_mesh_error.h"
#include "supple/microscale/part_simulation.h"

/// Simulations of parts under supports, as requests and answers; they are read like those of requests.h.
namespace supple::json {

inline constexpr auto side_names = names_of<microscale::Side>({{microscale::Side::bottom, "bottom"},
                                                               {microscale::Side::top, "top"},
                                                               {microscale::Side::left, "left"},
                                                               {microscale::Side::right, "right"}});
inline constexpr auto friction_names =
    names_of<microscale::Friction>({{microscale::Friction::none, "none"}, {microscale::Friction::stick, "stick"}});

enum class DeformedPart { none, json, obj, vtu };
inline constexpr auto deformed_part_names = names_of<DeformedPart>({{DeformedPart::none, "none"},
                                                                    {DeformedPart::json, "json"},
                                                                    {DeformedPart::obj, "obj"},
                                                                    {DeformedPart::vtu, "vtu"}});

struct PartSimulationRequest {
  PartRequest part;
  std::vector<microscale::Support> supports;  ///< those of the request, or the default ones of a coupon or a block
  bool has_default_supports = false;
  microscale::PartSimulationOptions options;
  tiling::MeshOptions mesh;
  Switch error_estimate = Switch::automatic;
  DeformedPart deformed = DeformedPart::none;
  bool svg = false;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
PartSimulationRequest parse_part_simulation(std::string_view body, const Limits& limits,
                                            const CancellationToken& cancellation = {});

/// What the answer tells of a computation.
struct PartSimulationOutcome {
  const tiling::Part& part;
  const tiling::PeriodicMesh& mesh;
  const microscale::PartSimulationResult& result;
  const std::optional<microscale::PartMeshError>& mesh_error;
};

/// Pictures and deformed parts are written where the request asks for them; the states then have displacements.
std::string write_part_simulation(const PartSimulationRequest& request, const PartSimulationOutcome& simulated,
                                  const Bill& bill);

/// The state that was reached last, of which `number` counts from 1, as an intermediate result.
std::string write_partial_part_simulation(const PartSimulationRequest& request, int number,
                                          const microscale::PartState& state);

}  // namespace supple::json
