#include "supple/weave/shortcuts.h"

#include <utility>

#include "supple/numerics/rows.h"

namespace supple::weave {
namespace {

Eigen::VectorXd values_of(const std::vector<DirectionalResponse>& responses, double DirectionalResponse::*value) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(responses.size()));
  for (std::size_t i = 0; i < responses.size(); ++i) values[static_cast<Eigen::Index>(i)] = responses[i].*value;
  return values;
}

}  // namespace

Weave weave_of(const std::vector<Eigen::MatrixXd>& strands, double radius, const Material& material,
               const Execution& execution) {
  Weave weave;
  weave.material = material;
  for (const Eigen::MatrixXd& points : strands) {
    StrandCurve curve(numerics::vectors_of<2>(points, "points"), Ends::open, Eigen::Vector2d::Zero(), execution);
    weave.strands.push_back({std::move(curve), radius});
  }
  weave.crossings = find_crossings(weave.strands, weave.lattice, execution);
  return weave;
}

std::vector<DirectionalResponse> homogenize_over_half_turn(const Weave& weave, int directions, double strain,
                                                           const Execution& execution) {
  HomogenizationOptions options;
  options.strain = strain;
  options.directions = directions_over_half_turn(directions);
  return homogenize(weave, options, execution);
}

Eigen::VectorXd youngs_moduli(const std::vector<DirectionalResponse>& responses) {
  return values_of(responses, &DirectionalResponse::youngs_modulus);
}

Eigen::VectorXd poisson_ratios(const std::vector<DirectionalResponse>& responses) {
  return values_of(responses, &DirectionalResponse::poisson_ratio);
}

}  // namespace supple::weave
