#include "out_of_plane.h"

#include "supple/base/error.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/least_stable_mode.h"

namespace supple::weave {
namespace {

/// Smallest negative curvature that counts as an instability, as a fraction of the matrix's scale. Strands that lie
/// loose have curvatures of 0 up to rounding.
constexpr double min_instability = 1e-9;

}  // namespace

SpatialState lift(const RodModel& planar, const Eigen::VectorXd& q, const RodModel& spatial) {
  SpatialState state;
  state.q = spatial.rest_state();
  for (int i = 0; i < static_cast<int>(planar.nodes().size()); ++i)
    state.q.segment<2>(spatial.position(i)) = q.segment<2>(planar.position(i));
  for (int i = 0; i < static_cast<int>(planar.sliders().size()); ++i) state.q[spatial.slider(i)] = q[planar.slider(i)];
  std::vector<double> angles;
  angles.reserve(static_cast<std::size_t>(planar.joints()));
  for (int j = 0; j < planar.joints(); ++j) angles.push_back(q[planar.joint(j)]);
  if (planar.weave().lattice) state.q.segment<4>(spatial.strain()) = q.segment<4>(planar.strain());
  state.chart = flat_chart(spatial, state.q, angles);
  return state;
}

std::vector<bool> lift_fixed(const RodModel& planar, const std::vector<bool>& fixed, const RodModel& spatial) {
  std::vector<bool> result = gauge_constraints(spatial);
  const auto copy = [&](int from, int to) {
    if (fixed[static_cast<std::size_t>(from)]) result[static_cast<std::size_t>(to)] = true;
  };
  for (int i = 0; i < static_cast<int>(planar.nodes().size()); ++i)
    for (int c = 0; c < 2; ++c) copy(planar.position(i) + c, spatial.position(i) + c);
  for (int i = 0; i < static_cast<int>(planar.sliders().size()); ++i) copy(planar.slider(i), spatial.slider(i));
  for (int j = 0; j < planar.joints(); ++j) copy(planar.joint(j), spatial.joint(j) + 2);
  if (planar.weave().lattice)
    for (int k = 0; k < 4; ++k) copy(planar.strain() + k, spatial.strain() + k);
  return result;
}

std::optional<Eigen::VectorXd> out_of_plane_mode(const RodModel& spatial, const SpatialState& state,
                                                 const std::vector<bool>& fixed, const EnergyOptions& options,
                                                 const Execution& execution) {
  const StageTimer timer(execution.cost, "out-of-plane stability");
  std::vector<bool> fixed_with_plane(fixed.size(), true);
  const auto keep_constraint = [&](int dof) {
    fixed_with_plane[static_cast<std::size_t>(dof)] = fixed[static_cast<std::size_t>(dof)];
  };
  for (int i = 0; i < static_cast<int>(spatial.nodes().size()); ++i) keep_constraint(spatial.position(i) + 2);
  for (int e = 0; e < static_cast<int>(spatial.edges().size()); ++e) keep_constraint(spatial.angle(e));
  for (int j = 0; j < spatial.joints(); ++j)
    for (int c = 0; c < 2; ++c) keep_constraint(spatial.joint(j) + c);
  WeaveSystem objective(spatial, state.q, state.chart, fixed_with_plane, options, {}, {execution.cancellation});
  if (objective.dimension() == 0) return std::nullopt;
  const numerics::Evaluation at = objective.evaluate(2);
  numerics::ShiftedCholesky cholesky;
  cholesky.stop_with(execution.cancellation);
  const double scale = numerics::matrix_scale(at.hessian);
  if (cholesky.factorize(at.hessian, min_instability * scale)) return std::nullopt;
  const auto mode = numerics::least_stable_mode(at.hessian, objective.dimension(), cholesky, execution.cancellation);
  if (!mode) throw Error("minimizer.not_finite", "The stiffness of the weave out of its plane is not finite.");
  if (!(mode->curvature < -min_instability * scale)) return std::nullopt;
  return objective.expand(mode->direction);
}

}  // namespace supple::weave
