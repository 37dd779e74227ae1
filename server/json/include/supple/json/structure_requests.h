#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/json/limits.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/export.h"
#include "supple/tiling/mesh.h"

/// The requests about structures as types; they are read like those of requests.h and throw the same. Whether a family
/// exists and its parameters give a structure is not checked here.
namespace supple::json {

/// A member of a family; without parameters the family's default.
struct StructureSpec {
  std::string family;
  std::optional<std::vector<double>> parameters;
};

struct StructureRequest {
  StructureSpec structure;
  double beam_width = tiling::printed_beam_width;  ///< mm
  tiling::ExportOptions files;
  std::optional<tiling::MeshOptions> mesh;  ///< set where statistics are asked for
  bool svg = false;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
StructureRequest parse_structure(std::string_view body, const Limits& limits);

enum class Deformed { none, json, vtu };

struct SimulationRequest {
  StructureSpec structure;
  microscale::Load load;
  /// Where the request leaves the mesh to the server, the mesh is `microscale::extrapolated_mesh`.
  microscale::SimulationOptions options;
  /// The relative error of the stress that the mesh may make, where the request names it.
  std::optional<double> accepted_error;
  bool mesh_given = false;  ///< whether the request has a mesh size, which then wins over the accepted error
  Deformed deformed = Deformed::none;
  double deadline = 0;
};
SimulationRequest parse_simulation(std::string_view body, const Limits& limits);

}  // namespace supple::json
