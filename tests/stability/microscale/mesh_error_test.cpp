// Estimated errors of meshes in cases in which the states of the coarse and the fine mesh differ much.
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>

#include "simulation_case.h"
#include "supple/microscale/accurate_simulation.h"
#include "support/drawn_meshes.h"
#include "support/expect_error.h"

namespace supple::microscale {
namespace {

SimulationOptions saying_options(Refinement refinement = Refinement::extrapolated) {
  SimulationOptions options = accurate_options();
  options.refinement = refinement;
  options.tolerance = 1e-7;
  options.deformed_meshes = true;
  return options;
}

/// Expects that estimated errors are finite numbers, and that the path has one if and only if every converged state
/// does.
void expect_honest(const SimulationResult& result) {
  bool all = true;
  for (const State& state : result.states) {
    EXPECT_TRUE(state.stress.allFinite());
    if (state.stopped != Stop::converged) continue;
    all = all && state.mesh_error.has_value();
    if (!state.mesh_error) continue;
    EXPECT_TRUE(std::isfinite(state.mesh_error->stress));
    EXPECT_TRUE(std::isfinite(state.mesh_error->energy_density));
    EXPECT_GE(state.mesh_error->stress, 0);
    EXPECT_GE(state.mesh_error->energy_density, 0);
  }
  const auto error = discretization_error(result.states);
  EXPECT_EQ(error.has_value(), all);
  if (!error) return;
  EXPECT_TRUE(std::isfinite(error->stress));
  EXPECT_TRUE(std::isfinite(error->energy_density));
}

const std::vector<double> folded{0.2399, 0.5547, 0.0665, 0.4047};
const std::vector<double> touching{0.1191, 0.3178, 0.1199, 0.6276};

double norm_of(const Eigen::Vector3d& t) { return std::sqrt(t[0] * t[0] + t[1] * t[1] + 2 * t[2] * t[2]); }

// Hard: a folded tile requires a mesh of the whole cell. It has slivers between beams that are close to each other at
// rest.
TEST(MeshErrorCases, AFoldedTileSaysItsError) {
  for (const Refinement refinement : {Refinement::extrapolated, Refinement::estimated})
    expect_honest(follow("IH01", folded, BiaxialLoad{2.304, {{1.001, 0.939}}}, saying_options(refinement)));
}

// Hard: beams buckle with a period of two cells, and dozens of pairs of boundary points touch on both meshes.
TEST(MeshErrorCases, BeamsThatBuckleAndTouchSayTheirError) {
  const UniaxialLoad load{2.094, {0.95, 0.9, 0.839}};
  const SimulationResult result = follow("IH01", touching, load, saying_options());
  expect_honest(result);
  EXPECT_EQ(result.states.back().cells, 2) << "the case does not buckle over two cells";
  EXPECT_GT(result.states.back().contacts, 0) << "the case does not touch";
}

// Hard: close to the load at which beams buckle, they have buckled on one mesh and not yet on the other.
TEST(MeshErrorCases, NearBucklingTheErrorOfEitherBranchIsSaid) {
  UniaxialLoad load{2.094, {}};
  for (int k = 0; k <= 30; ++k) load.stretches.push_back(0.987 - 0.0001 * k);
  const SimulationResult result = follow("IH01", touching, load, saying_options());
  expect_honest(result);
  EXPECT_EQ(result.states.front().cells, 1);
  EXPECT_EQ(result.states.back().cells, 2) << "the case does not buckle";
  // Just after buckling, the fine mesh is farther along the new branch. These states are not extrapolated. Later ones
  // are, so that the response jumps. The estimated error must cover the jump.
  double largest_jump = 0;
  for (std::size_t k = 0; k + 1 < result.states.size(); ++k) {
    const State& state = result.states[k];
    if (state.cells == 1) continue;
    ASSERT_TRUE(state.mesh_error) << "stretch " << load.stretches[k];
    const double jump = norm_of(state.stress - result.states[k + 1].stress);
    largest_jump = std::max(largest_jump, jump / norm_of(state.stress));
    EXPECT_LT(jump, state.mesh_error->stress) << "stretch " << load.stretches[k];
  }
  EXPECT_GT(largest_jump, 0.01) << "no state lies between the two meshes' buckling";
}

/// The difference between the change of the stress over a short step of strain and the integral of the tangents by
/// Simpson's rule, divided by the estimated error of the stress. None if a state is missing or not smooth: it did not
/// converge, is unstable, has contacts or no estimate, or is on another branch.
std::optional<double> broken_derivative(RandomStream& random) {
  constexpr double length = 2e-3;
  const Design design = draw_design(random);
  const double direction = random.uniform(0, std::numbers::pi);
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(direction).toRotationMatrix();
  const Eigen::Vector2d stretches(1 - random.uniform(0.04, 0.12), 1 + random.uniform(-0.06, 0.1));
  const Eigen::Matrix2d strain =
      turn * (0.5 * (stretches.cwiseAbs2().array() - 1)).matrix().asDiagonal() * turn.transpose();
  const Eigen::Vector3d from(strain(0, 0), strain(1, 1), strain(0, 1));
  Eigen::Vector3d step(random.normal(), random.normal(), random.normal());
  step *= length / norm_of(step);
  SimulationOptions options = accurate_options();
  options.tolerance = 1e-9;
  const GreenStrainLoad load{{0.5 * from, from, from + 0.5 * step, from + step}};
  const SimulationResult result = Simulator(design.structure, options).run(load);
  if (result.states.size() != 4) return std::nullopt;
  const State* states = &result.states[1];
  for (int k = 0; k < 3; ++k) {
    const bool smooth = states[k].stopped == Stop::converged && states[k].stable && states[k].contacts == 0 &&
                        states[k].branch == states[0].branch && states[k].mesh_error;
    if (!smooth) return std::nullopt;
  }
  const Eigen::Vector3d change(step[0], step[1], 2 * step[2]);
  // If there is a bifurcation between the states, the tangent jumps, and the rule does not apply.
  if ((states[2].tangent - states[0].tangent).norm() > 0.5 * states[1].tangent.norm()) return std::nullopt;
  const Eigen::Vector3d integral = (states[0].tangent + 4 * states[1].tangent + states[2].tangent) * change / 6;
  return norm_of(states[2].stress - states[0].stress - integral) / states[1].mesh_error->stress;
}

// Hard: past a bifurcation, the nodes' response to strains changes fast from the coarse mesh's state to that of the
// fine mesh. A tangent that is computed from one response alone has an error of up to 40 %.
TEST(MeshErrorCases, PastABifurcationTangentsAreTheDerivativesOfTheStress) {
  int compared = 0;
  for (int k = 20; k < 28; ++k) {
    SCOPED_TRACE(k);
    RandomStream random("derivatives past bifurcations", k);
    const std::optional<double> broken = broken_derivative(random);
    if (!broken) continue;
    ++compared;
    EXPECT_LT(*broken, 0.1);
  }
  EXPECT_GT(compared, 5);
}

// Hard: without a load, the stress to which an error could be relative is zero.
TEST(MeshErrorCases, RestHasNoError) {
  for (const Refinement refinement : {Refinement::extrapolated, Refinement::estimated}) {
    const GreenStrainLoad load{{Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, 1e-14), Eigen::Vector3d(1e-9, 0, 0)}};
    const SimulationResult result = follow("IH22", preset("IH22"), load, saying_options(refinement));
    expect_honest(result);
    ASSERT_TRUE(result.states[0].mesh_error);
    EXPECT_LT(result.states[0].mesh_error->stress, 1e-10);
    // The relative error at a small strain is no larger than at other strains.
    const auto error = discretization_error({result.states[2]});
    ASSERT_TRUE(error);
    EXPECT_LT(error->stress, 0.1);
  }
}

// Hard: a free wall has no stress and no scale of forces until it touches its image.
TEST(MeshErrorCases, AFreeWallThatClosesAGapSaysItsError) {
  SimulationOptions options = saying_options();
  Simulator simulator(testing::wall(0.05, 4), options);
  const SimulationResult result = simulator.run(BiaxialLoad{0, {{0.99, 1}, {0.97, 1}, {0.94, 1}}});
  ASSERT_EQ(result.states.size(), 3U) << result.message;
  expect_honest(result);
  EXPECT_GT(result.states[2].contacts, 0);
}

// Hard: the limit of nodes allows the mesh but no finer one, or not even the coarsest mesh.
TEST(MeshErrorCases, AMeshAtItsLimitSaysNothingRatherThanSomethingWrong) {
  const tiling::Structure structure = tiling::make_structure(tiling::family("IH22"), preset("IH22"));
  SimulationOptions options = saying_options();
  options.mesh.max_nodes = 2 * static_cast<int>(Simulator(structure, options).mesh().nodes.cols());
  const Load load = UniaxialLoad{0.3, {1.02, 1.05}};
  const SimulationResult result = Simulator(structure, options).run(load);
  expect_honest(result);
  EXPECT_FALSE(result.extrapolated);
  EXPECT_FALSE(discretization_error(result.states));
  options.mesh.max_nodes = 40;
  ::supple::testing::expect_error("tiling.mesh_too_large", [&] { simulate_within(structure, load, options, 0.01); });
}

/// Requests a stop at the progress report of this number.
class StopAt : public ProgressSink {
 public:
  StopAt(CancellationToken token, int reports) : token_(std::move(token)), left_(reports) {}
  void report(double /*fraction*/, std::string_view /*stage*/) override {
    if (--left_ == 0) token_.request(StopReason::cancelled);
  }

 private:
  CancellationToken token_;
  int left_;
};

// Hard: a stop request ends a path with contacts in the middle, and the fine mesh keeps contacts and factors from
// there.
TEST(MeshErrorCases, ACancelledPathLeavesNothingBehind) {
  const tiling::Structure structure = tiling::make_structure(tiling::family("IH01"), touching);
  const Load load = UniaxialLoad{2.094, {0.95, 0.9}};
  const SimulationResult wanted = Simulator(structure, saying_options()).run(load);
  Simulator simulator(structure, saying_options());
  for (const int reports : {1, 2}) {
    Execution execution;
    StopAt stop(execution.cancellation, reports);
    execution.progress = &stop;
    ::supple::testing::expect_cancelled(StopReason::cancelled, [&] { simulator.run(load, execution); });
  }
  const SimulationResult found = simulator.run(load);
  ASSERT_EQ(found.states.size(), wanted.states.size());
  for (std::size_t k = 0; k < found.states.size(); ++k) {
    EXPECT_LT(norm_of(found.states[k].stress - wanted.states[k].stress), 1e-9 * norm_of(wanted.states[k].stress));
    ASSERT_EQ(found.states[k].mesh_error.has_value(), wanted.states[k].mesh_error.has_value());
    if (wanted.states[k].mesh_error) {
      EXPECT_NEAR(found.states[k].mesh_error->stress, wanted.states[k].mesh_error->stress,
                  1e-4 * wanted.states[k].mesh_error->stress);
    }
  }
}

}  // namespace
}  // namespace supple::microscale
