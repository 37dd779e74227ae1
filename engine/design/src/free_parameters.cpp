#include "free_parameters.h"

#include <string>
#include <utility>

#include "supple/base/error.h"
#include "supple/base/number_text.h"
#include "supple/design/design_fault.h"

namespace supple::design {
namespace {

/// A value beyond a bound by less than this counts as rounding; fraction of the bounds' width.
constexpr double bound_rounding = 1e-9;

void check_bounds(const neural::Network& network, std::string where, Eigen::Index k, double value,
                  std::vector<Error::Detail>& faults) {
  const double rounding = bound_rounding * (network.upper[k] - network.lower[k]);
  if (value >= network.lower[k] - rounding && value <= network.upper[k] + rounding) return;
  faults.push_back({std::move(where), "must be within [" + number_text(network.lower[k]) + ", " +
                                          number_text(network.upper[k]) + "], got " + number_text(value)});
}

}  // namespace

FreeParameters::FreeParameters(const DesignSpace& space, const DesignProblem& problem)
    : lower(all_of(space.model.network.lower, problem.orientation.least)),
      upper(all_of(space.model.network.upper, problem.orientation.most)),
      fixed_values(0.5 * (lower + upper)) {
  const neural::Network& network = space.model.network;
  const Eigen::Index n = network.lower.size();
  const std::string count = "The family " + space.model.family + " has " + std::to_string(n) + " parameters";
  if (problem.initial && problem.initial->size() != n)
    throw DesignFault("design.parameter_count", count + ", not " + std::to_string(problem.initial->size()) + ".",
                      {{"initial", count}});
  if (!problem.fixed.empty() && static_cast<Eigen::Index>(problem.fixed.size()) != n)
    throw DesignFault("design.parameter_count", count + ", not " + std::to_string(problem.fixed.size()) + ".",
                      {{"fixed", count}});
  std::vector<Error::Detail> faults;
  for (Eigen::Index k = 0; k < n; ++k) {
    if (problem.initial) check_bounds(network, "initial/" + std::to_string(k), k, (*problem.initial)[k], faults);
    const bool is_fixed = !problem.fixed.empty() && problem.fixed[static_cast<std::size_t>(k)];
    if (!is_fixed) {
      free.push_back(k);
      continue;
    }
    fixed_values[k] = *problem.fixed[static_cast<std::size_t>(k)];
    check_bounds(network, "fixed/" + std::to_string(k), k, fixed_values[k], faults);
    lower[k] = upper[k] = fixed_values[k];
  }
  if (orientation_is_free()) free.push_back(n);
  if (!faults.empty())
    throw DesignFault("design.parameter_out_of_bounds",
                      "Parameter " + faults.front().where + " " + faults.front().message + ".", faults);
}

Eigen::VectorXd FreeParameters::free_part(const Eigen::VectorXd& all) const {
  Eigen::VectorXd part(static_cast<Eigen::Index>(free.size()));
  for (std::size_t k = 0; k < free.size(); ++k) part[static_cast<Eigen::Index>(k)] = all[free[k]];
  return part;
}

std::vector<Eigen::Index> FreeParameters::free_of_family() const {
  auto indices = free;
  if (orientation_is_free()) indices.pop_back();
  return indices;
}

Eigen::VectorXd FreeParameters::all_of(const Eigen::VectorXd& parameters, double orientation) {
  Eigen::VectorXd all(parameters.size() + 1);
  all << parameters, orientation;
  return all;
}

Eigen::VectorXd all_parameters(Eigen::VectorXd fixed_values, const std::vector<Eigen::Index>& free,
                               const Eigen::VectorXd& part) {
  for (std::size_t k = 0; k < free.size(); ++k) fixed_values[free[k]] = part[static_cast<Eigen::Index>(k)];
  return fixed_values;
}

}  // namespace supple::design
