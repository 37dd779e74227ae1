#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bill.h"
#include "report.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/family.h"

/// The studies of the simulation benchmark. Each writes a page of its own, so that a long one can be repeated alone.
namespace supple::bench {

struct SimulationSettings {
  std::filesystem::path folder = "docs/bench";
  /// Few designs and coarse meshes: shows that the program works, not what the numbers are.
  bool brief = false;
  /// Random designs of each family; 0 for as many as the study is meant to have.
  int designs = 0;

  /// Families to study; empty for those that the study is meant to have.
  std::vector<std::string> families{};

  int designs_or(int usual) const { return designs > 0 ? designs : usual; }
  std::vector<std::string> families_or(std::vector<std::string> usual) const {
    return families.empty() ? usual : families;
  }
};

/// "This page is generated ...", the machine and the commands; `conditions` follows.
std::string simulation_introduction(const SimulationSettings& settings, const std::string& study,
                                    const std::string& conditions);

/// The first n structures that the engine accepts among random designs uniform in the family's box. Deterministic; the
/// designs of one family are the same for all studies.
std::vector<tiling::Structure> random_structures(const std::string& family, int n);
/// The family's structure at its defaults.
tiling::Structure default_structure(const std::string& family);
/// The seven published families.
const std::vector<std::string>& published_families();

/// What the family's data set is made with.
microscale::SimulationOptions data_set_options(const std::string& family);
/// "1/2, 0.1": length of a side over the beam width, and the size at re-entrant corners over that elsewhere.
std::string mesh_name(const tiling::MeshOptions& mesh);

/// States of one simulator's load paths and what they cost.
using TimedPath = Billed<microscale::SimulationResult>;
TimedPath run_timed(microscale::Simulator& simulator, const microscale::Load& load);

/// The Frobenius norm of a symmetric tensor (xx, yy, xy).
double frobenius(const Eigen::Vector3d& t);
/// |S - S_ref| / |S_ref| in the Frobenius norm.
double stress_error(const microscale::State& state, const microscale::State& reference);
/// Whether the state is stable and on the branch that begins at rest.
bool before_buckling(const microscale::State& state);

void study_refinement(const SimulationSettings& settings);
void study_simulation_accuracy(const SimulationSettings& settings);
void study_speed(const SimulationSettings& settings);
void study_peer(const SimulationSettings& settings);
void study_effects(const SimulationSettings& settings);
void study_discretization(const SimulationSettings& settings);
void study_smoothness(const SimulationSettings& settings);

}  // namespace supple::bench
