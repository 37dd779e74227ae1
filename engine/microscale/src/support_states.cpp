#include "support_states.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace supple::microscale {
namespace {

std::size_t place(Eigen::Index i) { return static_cast<std::size_t>(i); }

PlatePressure pressure_of(const PartSupports::Surface& surface, const PartSupports& supports,
                          const Constraints& constraints, const Eigen::VectorXd& x, const Eigen::VectorXd& gradient,
                          double fraction, double length) {
  const Eigen::Matrix2Xd& nodes = supports.mesh().nodes;
  const int along = 1 - surface.axis;
  const double shift = fraction * supports.displacement(surface.support)[along];
  const double origin = nodes.row(along).minCoeff();
  struct Push {
    double at;     ///< coordinate along the plate, relative to the plate
    double force;  ///< MPa mm
  };
  std::vector<Push> pushes;
  double first = origin;
  double last = nodes.row(along).maxCoeff();
  for (const PartSupports::Candidate& candidate : supports.candidates()) {
    const Eigen::Index dof = 2 * static_cast<Eigen::Index>(candidate.node) + surface.axis;
    if (constraints.support[place(dof)] != surface.support) continue;
    const double at = nodes(along, candidate.node) + x[2 * static_cast<Eigen::Index>(candidate.node) + along] - shift;
    pushes.push_back({at, surface.sign * gradient[dof]});
    first = std::min(first, at);
    last = std::max(last, at);
  }
  // The intervals begin at the part's corner, and cover the part and whatever touches the plate beyond it.
  const auto begin = static_cast<std::int64_t>(std::floor((first - origin) / length + 1e-9));
  const auto end = std::max(begin + 1, static_cast<std::int64_t>(std::ceil((last - origin) / length - 1e-9)));
  PlatePressure pressure;
  for (std::int64_t k = begin; k < end; ++k)
    pressure.positions.push_back(origin + (static_cast<double>(k) + 0.5) * length);
  pressure.values.assign(pressure.positions.size(), 0.0);
  for (const Push& push : pushes) {
    const auto k = std::clamp(static_cast<std::int64_t>(std::floor((push.at - origin) / length)), begin, end - 1);
    pressure.values[static_cast<std::size_t>(k - begin)] += push.force / length;
  }
  return pressure;
}

}  // namespace

std::vector<SupportState> support_states(const PartSupports& supports, const Constraints& constraints,
                                         const Eigen::VectorXd& x, const Eigen::VectorXd& gradient, double fraction,
                                         double thickness, double pressure_length) {
  const Eigen::Matrix2Xd& nodes = supports.mesh().nodes;
  std::vector<SupportState> states(supports.count());
  std::vector<int> last(supports.count(), -1);  // the last node that was counted
  for (std::size_t k = 0; k < states.size(); ++k)
    states[k].displacement = fraction * supports.displacement(static_cast<int>(k));
  for (Eigen::Index dof = 0; dof < nodes.size(); ++dof) {
    const int support = constraints.support[place(dof)];
    if (support < 0) continue;
    SupportState& state = states[place(support)];
    state.force[dof % 2] += thickness * gradient[dof];
    const int node = static_cast<int>(dof / 2);
    if (std::exchange(last[place(support)], node) != node) ++state.touching;
  }
  for (const PartSupports::Surface& surface : supports.surfaces())
    states[place(surface.support)].pressure =
        pressure_of(surface, supports, constraints, x, gradient, fraction, pressure_length);
  return states;
}

}  // namespace supple::microscale
