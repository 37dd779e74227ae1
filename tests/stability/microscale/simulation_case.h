#pragma once

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "contact_outline.h"
#include "supple/base/error.h"
#include "supple/base/random.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/family.h"
#include "supple/tiling/structure.h"

namespace supple::microscale {

/// A random design of a random family.
struct Design {
  std::string family;
  std::vector<double> parameters;
  tiling::Structure structure;
};

/// Draws a random design. Parameters that the family refuses are drawn again.
inline Design draw_design(RandomStream& random) {
  const auto& all = tiling::families();
  const tiling::Family& family = all[random.below(static_cast<int>(all.size()))];
  for (;;) {
    std::vector<double> parameters;
    for (const tiling::Parameter& p : family.parameters) parameters.push_back(random.uniform(p.lower, p.upper));
    try {
      return {family.id, parameters, tiling::make_structure(family, parameters)};
    } catch (const Error&) {
      continue;
    }
  }
}

/// Options with a mesh a little coarser than that of the data sets.
inline SimulationOptions hard_case_options(double mesh_size = 0.5) {
  SimulationOptions options;
  options.mesh.mesh_size = mesh_size;
  options.mesh.corner_size = 0.2;
  options.tolerance = 1e-7;
  options.deformed_meshes = true;
  return options;
}

inline std::vector<double> preset(const std::string& id) {
  std::vector<double> parameters;
  for (const tiling::Parameter& p : tiling::family(id).parameters) parameters.push_back(p.preset);
  return parameters;
}

/// Whether the outline of a deformed patch crosses itself or an image of itself.
inline bool intersects(const DeformedMesh& deformed) {
  const tiling::PeriodicMesh& mesh = *deformed.mesh;
  const Eigen::Matrix2d f = deformed.lattice * mesh.lattice.inverse();
  Eigen::VectorXd x(2 * mesh.nodes.cols() + 4);
  Eigen::Map<Eigen::Matrix2Xd>(x.data(), 2, mesh.nodes.cols()) = deformed.nodes - f * mesh.nodes;
  x.tail<4>() << f(0, 0) - 1, f(0, 1), f(1, 0), f(1, 1) - 1;
  return intersects(ContactOutline(mesh), x);
}

/// Expects what must hold for every equilibrium under any load.
inline void expect_sound(const State& state) {
  EXPECT_EQ(state.stopped, Stop::converged) << to_string(state.stopped);
  EXPECT_LE(state.residual, 1e-6);
  EXPECT_GT(state.smallest_jacobian, 0);
  // Rounding may give an energy a little below zero at rest.
  EXPECT_GE(state.energy_density, -1e-14);
  EXPECT_TRUE(state.stress.allFinite());
  if (state.tangent.allFinite()) {
    EXPECT_LE((state.tangent - state.tangent.transpose()).norm(), 1e-8 * state.tangent.norm());
  }
  ASSERT_TRUE(state.deformed.has_value());
  EXPECT_FALSE(intersects(*state.deformed)) << "the outline crosses itself";
}

/// Runs the load on a structure, and checks every state with `expect_sound`.
inline SimulationResult follow(const std::string& family, std::span<const double> parameters, const Load& load,
                               const SimulationOptions& options = hard_case_options()) {
  Simulator simulator(tiling::make_structure(tiling::family(family), parameters), options);
  SimulationResult result = simulator.run(load);
  EXPECT_EQ(static_cast<int>(result.states.size()), size(load)) << result.message;
  EXPECT_EQ(result.message, "");
  for (std::size_t k = 0; k < result.states.size(); ++k) {
    SCOPED_TRACE(::testing::Message() << family << ", state " << k);
    expect_sound(result.states[k]);
  }
  return result;
}

/// d . S d for d = (cos, sin), MPa.
inline double axial_stress(const State& state, double direction) {
  const double c = std::cos(direction);
  const double s = std::sin(direction);
  return c * c * state.stress[0] + s * s * state.stress[1] + 2 * c * s * state.stress[2];
}

/// Expects that energy increases along a path that leads away from rest, and that the stress opposes the load.
inline void expect_resistance(const SimulationResult& result, const UniaxialLoad& load) {
  double before = 0;
  for (std::size_t k = 0; k < result.states.size(); ++k) {
    SCOPED_TRACE(::testing::Message() << "stretch " << load.stretches[k]);
    EXPECT_GT(result.states[k].energy_density, before);
    EXPECT_GT(axial_stress(result.states[k], load.direction) * (load.stretches[k] - 1), 0);
    before = result.states[k].energy_density;
  }
}

}  // namespace supple::microscale
