#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bill.h"
#include "report.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/family.h"

/// The studies of the simulation benchmark. Each writes a section of simulations.md.
namespace supple::bench {

struct SimulationSettings {
  std::filesystem::path folder = "docs/bench";
  /// Few designs and coarse meshes: shows that the program works, not what the numbers are.
  bool brief = false;
  /// Random designs of each family; 0: the study's own number.
  int designs = 0;
  /// Families to study; empty: the study's own.
  std::vector<std::string> families{};

  int designs_or(int usual) const { return designs > 0 ? designs : usual; }
  std::vector<std::string> families_or(std::vector<std::string> usual) const {
    return families.empty() ? usual : families;
  }
};

/// The first n structures that the engine accepts among random designs uniform in the family's bounds. They are the
/// same in all studies.
std::vector<tiling::Structure> random_structures(const std::string& family, int n);
/// The family's structure at its defaults.
tiling::Structure default_structure(const std::string& family);
/// The seven published families.
const std::vector<std::string>& published_families();

/// The options with which the family's data set is made.
microscale::SimulationOptions data_set_options(const std::string& family);
/// For example "1/2, 0.1": length of a side over the beam width, and the size at re-entrant corners over that
/// elsewhere.
std::string mesh_name(const tiling::MeshOptions& mesh);

/// States of one load path and what they cost.
using TimedPath = Billed<microscale::SimulationResult>;
TimedPath run_timed(microscale::Simulator& simulator, const microscale::Load& load);

/// The Frobenius norm of a symmetric tensor (xx, yy, xy).
double frobenius(const Eigen::Vector3d& t);
/// |S - S_ref| / |S_ref| in the Frobenius norm.
double stress_error(const microscale::State& state, const microscale::State& reference);
/// Whether the state is stable and on the branch that begins at rest.
bool before_buckling(const microscale::State& state);

void study_simulation_accuracy(const SimulationSettings& settings);
void study_refinement(const SimulationSettings& settings);
void study_discretization(const SimulationSettings& settings);
void study_speed(const SimulationSettings& settings);
void study_effects(const SimulationSettings& settings);
void study_peer(const SimulationSettings& settings);

}  // namespace supple::bench
