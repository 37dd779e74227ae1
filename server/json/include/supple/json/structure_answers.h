#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "supple/json/answers.h"
#include "supple/json/structure_requests.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/family.h"
#include "supple/tiling/structure.h"

/// The answers about structures as JSON text; they throw like those of answers.h.
namespace supple::json {

/// `families` are answers of `write_family`.
std::string write_families(const std::vector<std::string>& families);
/// One family, `preset` being its structure at the default parameters. `created` is when it was added, in milliseconds
/// since 1970; nothing where it comes with the server.
std::string write_family(const tiling::Family& family, const tiling::Structure& preset,
                         std::optional<std::int64_t> created);

/// What the answer says about the mesh of one cell.
struct MeshedCell {
  tiling::MeshOptions options;
  tiling::MeshStatistics statistics;
};

/// `mesh` and `svg` are null where they were not asked for.
std::string write_structure(const tiling::Structure& structure, const MeshedCell* mesh, const std::string* svg,
                            const Bill& bill);

/// `cell` is the mesh of one cell. Numbers of a state that did not converge and are not finite are null where the
/// contract says so.
std::string write_simulation(const SimulationRequest& request, const tiling::Structure& structure,
                             const tiling::PeriodicMesh& cell, const microscale::SimulationResult& result,
                             const Bill& bill);

}  // namespace supple::json
