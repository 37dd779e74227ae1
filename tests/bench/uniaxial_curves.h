#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "supple/microscale/simulation.h"
#include "supple/neural/model.h"
#include "supple/tiling/family.h"

/// Uniaxial curves of random designs by simulation, which the studies of networks compare with.
namespace supple::bench {

/// The worst error in per cent of a uniaxial stress that [Thesis, sec. 4.4.3] reports.
inline constexpr double worst_allowed = 3.57;

/// The simulation pulls along a direction of space, F^T d = s d with the rest of F free: its stress is uniaxial, S =
/// sigma m m^T, along the direction m of the material that F^-1 d has. The thesis's problem for networks (4.9c) gives
/// m^T E m and leaves the other strains free: the same state, asked for along m.
struct MaterialLoad {
  double direction = 0;
  double green_strain = 0;
  double stress = 0;  ///< m^T S m
};

/// A state of a simulated curve.
struct Place {
  double stretch = 1;
  MaterialLoad load;
};
struct Curve {
  std::vector<double> parameters;
  double direction = 0;
  std::vector<Place> places;
  double seconds = 0;  ///< CPU time of one thread
};

/// The options of the family's data set without tangents, with a coarse mesh in a short run.
microscale::SimulationOptions curve_options(const std::string& family, bool brief);

/// The bounds in which a model was trained. Some families have structures outside them.
struct DesignBox {
  const tiling::Family& family;
  Eigen::VectorXd lower, upper;
};
DesignBox box_of(const neural::Model& model);

/// Curves of the first `wanted` random designs of the box that have a structure, in random directions: 24 places from
/// 30 % compression to 50 % tension each, fewer if a simulation does not arrive there.
///
/// Curves that earlier runs have simulated with the same options are read from `saved`, a text file with a line for
/// each. They do not depend on the models. Remove the file after a change of the simulation.
std::vector<Curve> simulated_curves(const DesignBox& box, const microscale::SimulationOptions& options, int wanted,
                                    const std::filesystem::path& saved);

}  // namespace supple::bench
