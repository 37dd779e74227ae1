#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "supple/dataset/recipe.h"

namespace supple::dataset {

/// The kind of a path's load, as it is stored.
enum class LoadKind : std::uint8_t { uniaxial = 0, biaxial = 1 };

/// One equilibrium of a path. Strains are Green strains, stresses are second Piola-Kirchhoff stresses, and everything
/// is per area of the whole cell at rest, including its holes.
struct Row {
  std::int32_t path = 0;                 ///< index into the design's paths
  std::int32_t position = 0;             ///< number of the state on its path, counted from 0
  std::array<double, 3> green_strain{};  ///< E_xx, E_yy, E_xy (tensor components)
  double energy_density = 0;             ///< MPa
  std::array<double, 3> stress{};        ///< S_xx, S_yy, S_xy, MPa
  std::array<double, 6> tangent{};       ///< dS/d(E_xx, E_yy, 2 E_xy), MPa: 11, 12, 13, 22, 23, 33; NaN if singular
  double stretch = 1;                    ///< s along the path's direction
  double lateral_stretch = 0;            ///< s0 across it; 0 where it is free (uniaxial)
  double residual = 0;                   ///< |g| / f as in microscale::SimulationOptions::tolerance
  double smallest_jacobian = 1;          ///< least det F over all elements
  double seconds = 0;                    ///< time of the working thread since the path's previous row
  std::int32_t iterations = 0;           ///< Newton iterations since the path's previous row
  std::int32_t branch = 0;               ///< how many unstable branches the path has left so far
  std::int32_t contacts = 0;             ///< pairs within the contact barrier's range
  std::int32_t cells = 1;                ///< cells along each side of the simulated patch: 1 or 2
  bool stable = true;                    ///< whether the stiffness is positive definite for all modes that were checked
};

/// One load path from rest. Only converged states become rows. A path that ended early says where and why.
struct Path {
  LoadKind kind = LoadKind::uniaxial;
  double direction = 0;            ///< rad
  double end_stretch = 1;          ///< s of its last state
  double end_lateral_stretch = 0;  ///< s0 of its last state; 0 where it is free
  std::int32_t planned = 0;        ///< number of states that were requested
  std::int32_t reached = 0;        ///< number of them that became rows
  std::string stopped;             ///< "converged", or why the simulation ended early, or an error's code
  std::string message;             ///< empty if it converged
};

/// The cost of one stage of a design's simulation.
struct StageCost {
  std::string name;
  double seconds = 0;
  std::int64_t count = 0;  ///< how often the stage ran
};

/// Everything that the simulation of one design gave.
struct Design {
  std::int64_t index = 0;
  std::vector<double> parameters;
  std::string engine;         ///< version of the engine that computed it
  std::string error_code;     ///< empty unless the design was rejected
  std::string error_message;  ///< empty unless the design was rejected
  std::int32_t nodes = 0;     ///< number of nodes of one cell's mesh
  std::int32_t unknowns = 0;  ///< number of unknowns of the largest system that was solved
  double seconds = 0;         ///< time of the working thread, including meshing
  std::vector<Path> paths;
  std::vector<Row> rows;  ///< sorted by path, then by position
  std::vector<StageCost> costs;

  bool rejected() const { return !error_code.empty(); }
};

/// The requested designs of the recipe's sequence: i in [first, first + count) with i mod shards = shard.
struct Selection {
  std::int64_t first = 0;
  std::int64_t count = 0;
  std::int64_t shard = 0;
  std::int64_t shards = 1;
  bool operator==(const Selection&) const = default;

  std::vector<std::int64_t> indices() const;
};

struct Dataset {
  Recipe recipe;
  Selection selection;
  std::vector<Design> designs;  ///< sorted by index, each once
};

/// The indices of the designs that the selection contains and the data set lacks.
std::vector<std::int64_t> missing_designs(const Dataset& data);

}  // namespace supple::dataset
