#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bill.h"
#include "report.h"
#include "supple/weave/homogenization.h"
#include "supple/weave/patterns.h"
#include "supple/weave/simulation.h"

/// The studies of the weave benchmark. Each writes a section of weaves.md.
namespace supple::bench {

struct WeaveSettings {
  std::filesystem::path folder = "docs/bench";
  /// Few directions and small sheets: shows that the program works, not what the numbers are.
  bool brief = false;
};

/// 100 times the fraction, with two digits.
std::string percent(double fraction);

struct BenchCell {
  std::string name;
  weave::Weave weave;
};
/// Every pattern with every kind of crossing that it has.
std::vector<BenchCell> all_cells();
/// The cell of this name. Throws std::out_of_range if there is none.
BenchCell cell_named(const std::string& name);

using TimedCell = Billed<std::vector<weave::DirectionalResponse>>;
TimedCell run_timed(const weave::Weave& cell, const weave::HomogenizationOptions& options);
using TimedSheet = Billed<weave::SimulationResult>;
TimedSheet run_timed(const weave::Weave& sheet, const weave::SheetLoad& load,
                     const weave::EquilibriumOptions& options = {});
/// Sums over all states.
int iterations_of(const weave::SimulationResult& result);
int load_steps_of(const weave::SimulationResult& result);
bool converged(const weave::SimulationResult& result);

/// `count` directions over half a turn.
weave::HomogenizationOptions uniaxial(double strain, int count, const weave::EquilibriumOptions& equilibrium = {});

/// How a square sheet of straight strands is sheared.
enum class Shear {
  sinking,   ///< the lowest strand is fixed at all crossings, the highest one is moved aside and free to sink
  level,     ///< the same at constant height: strands must stretch
  diagonal,  ///< three crossings of one corner are fixed, those of the opposite corner are drawn towards it
};
struct LoadedSheet {
  weave::Weave weave;
  weave::SheetLoad load;
};
/// n x n strands at this pitch, n >= 3; moved by `amount` times the distance of the outermost strands.
LoadedSheet sheared_sheet(int n, weave::Connection connection, Shear shear, double amount);
inline constexpr double sheet_pitch = 4;  ///< mm

/// Differences of two profiles over the same directions, in those in which both reached the strain and both or none
/// left the plane.
struct ProfileError {
  double modulus_rms = 0;    ///< relative to the reference's root mean square
  double modulus_worst = 0;  ///< the largest difference, relative to the same
  double poisson_rms = 0;    ///< absolute
  int compared = 0;
  int left_out = 0;
};
ProfileError profile_error(const std::vector<weave::DirectionalResponse>& profile,
                           const std::vector<weave::DirectionalResponse>& reference);

/// Seconds of a bill by stage.
struct WeaveTimes {
  double assembly = 0;
  double factorization = 0;
  double solve = 0;
  double out_of_plane = 0;  ///< the search for unstable modes out of the plane
};
WeaveTimes times_of(const CostLedger& cost);

void study_weave_accuracy(const WeaveSettings& settings);
void study_weave_speed(const WeaveSettings& settings);
void study_weave_effects(const WeaveSettings& settings);

}  // namespace supple::bench
