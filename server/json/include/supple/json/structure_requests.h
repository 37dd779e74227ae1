#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/json/limits.h"
#include "supple/json/name_table.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/export.h"
#include "supple/tiling/mesh.h"

/// The requests about structures as types; they are read like those of requests.h and throw the same. Whether a family
/// exists and its parameters give a structure is not checked here.
namespace supple::json {

inline constexpr auto region_names = names_of<tiling::Region>(
    {{tiling::Region::automatic, "automatic"}, {tiling::Region::tile, "tile"}, {tiling::Region::cell, "cell"}});
inline constexpr auto load_frame_names = names_of<microscale::LoadFrame>(
    {{microscale::LoadFrame::space, "space"}, {microscale::LoadFrame::material, "material"}});
inline constexpr auto law_names =
    names_of<microscale::Law>({{microscale::Law::neo_hookean, "neo_hookean"},
                               {microscale::Law::incompressible_plane_stress, "incompressible_plane_stress"}});

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
StructureRequest parse_structure(std::string_view body, const Limits& limits,
                                 const CancellationToken& cancellation = {});

enum class Deformed { none, json, vtu };
inline constexpr auto deformed_names =
    names_of<Deformed>({{Deformed::none, "none"}, {Deformed::json, "json"}, {Deformed::vtu, "vtu"}});

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
SimulationRequest parse_simulation(std::string_view body, const Limits& limits,
                                   const CancellationToken& cancellation = {});

}  // namespace supple::json
