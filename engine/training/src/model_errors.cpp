#include "supple/training/model_errors.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "supple/base/threads.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/uniaxial_frame.h"

namespace supple::training {
namespace {

/// The requested rows of one design, as positions in the list of requested rows.
struct DesignRows {
  const SampledDesign* design = nullptr;
  std::vector<int> positions;
};

std::vector<DesignRows> by_design(const Samples& samples, const std::vector<int>& rows) {
  std::vector<DesignRows> groups;
  // The rows of a design are consecutive in Samples. Once sorted, they form one group for each design.
  std::vector<int> positions(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) positions[i] = static_cast<int>(i);
  const auto row = [&](int position) { return rows[static_cast<std::size_t>(position)]; };
  std::sort(positions.begin(), positions.end(), [&](int a, int b) { return row(a) < row(b); });
  auto design = samples.designs.begin();
  for (const int position : positions) {
    while (row(position) >= design->first + design->count) ++design;
    if (groups.empty() || groups.back().design != &*design) groups.push_back({&*design, {}});
    groups.back().positions.push_back(position);
  }
  return groups;
}

double quantile_of_sorted(const std::vector<double>& sorted, double fraction) {
  const double position = fraction * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const auto above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

RowErrors row_errors(const neural::Network& network, const Samples& samples, const std::vector<int>& rows) {
  RowErrors errors;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(errors.rows),
               [&](int row) { return samples.energy[row] >= min_evaluated_energy; });
  const auto n = static_cast<long>(errors.rows.size());
  errors.energy.resize(n);
  errors.gradient.resize(n);
  errors.stiffness.resize(n);
  const neural::Evaluator evaluator(neural::without_mesh_correction(network));
  const auto groups = by_design(samples, errors.rows);
  parallel_for(static_cast<int>(groups.size()), [&](int g) {
    const auto& [sampled, positions] = groups[static_cast<std::size_t>(g)];
    Eigen::Matrix3Xd strains(3, static_cast<long>(positions.size()));
    for (std::size_t j = 0; j < positions.size(); ++j)
      strains.col(static_cast<long>(j)) = samples.strain.col(errors.rows[static_cast<std::size_t>(positions[j])]);
    const auto prediction = evaluator.evaluate(evaluator.design(sampled->parameters), strains, neural::Order::tangent);
    for (std::size_t j = 0; j < positions.size(); ++j) {
      const auto column = static_cast<long>(j);
      const int row = errors.rows[static_cast<std::size_t>(positions[j])];
      const Eigen::Vector3d simulated = samples.stress.col(row);
      errors.energy[positions[j]] = std::abs(prediction.energy_density[column] / samples.energy[row] - 1);
      errors.gradient[positions[j]] = (prediction.stress.col(column) - simulated).norm() / simulated.norm();
      const Eigen::Matrix3d tangent = neural::symmetric_matrix(samples.tangent.col(row));
      const Eigen::Vector3d v = tangent.fullPivLu().solve(simulated);
      errors.stiffness[positions[j]] =
          std::abs(v.dot(neural::symmetric_matrix(prediction.tangent.col(column)) * v) / v.dot(tangent * v) - 1);
    }
  });
  return errors;
}

double quantile(const Eigen::VectorXd& errors, double fraction) {
  std::vector<double> sorted(errors.begin(), errors.end());
  std::sort(sorted.begin(), sorted.end());
  return quantile_of_sorted(sorted, fraction);
}

neural::ErrorStatistics statistics(const Eigen::VectorXd& errors) {
  if (errors.size() == 0) return {};
  std::vector<double> sorted(errors.begin(), errors.end());
  std::sort(sorted.begin(), sorted.end());
  return {errors.mean(), std::sqrt(errors.squaredNorm() / static_cast<double>(errors.size())),
          quantile_of_sorted(sorted, 0.5), quantile_of_sorted(sorted, 0.99)};
}

neural::SplitErrors split_errors(const neural::Network& network, const Samples& samples, const std::vector<int>& rows) {
  const auto errors = row_errors(network, samples, rows);
  return {statistics(errors.energy), statistics(errors.gradient),
          static_cast<std::int64_t>(by_design(samples, errors.rows).size()),
          static_cast<std::int64_t>(errors.rows.size())};
}

neural::StrainRange strain_range(const neural::Network& network, const Samples& samples, const std::vector<int>& rows) {
  neural::StrainRange range;
  const neural::Evaluator evaluator(neural::without_mesh_correction(network));
  for (const auto& [sampled, positions] : by_design(samples, rows)) {
    const double stiffness = evaluator.design(sampled->parameters).rest_stiffness();
    for (const int position : positions) {
      const int row = rows[static_cast<std::size_t>(position)];
      const Eigen::Vector3d e = samples.strain.col(row);
      const double middle = 0.5 * (e[0] + e[1]);
      const double radius = std::hypot(0.5 * (e[0] - e[1]), 0.5 * e[2]);
      range.smallest_principal = std::min(range.smallest_principal, middle - radius);
      range.largest_principal = std::max(range.largest_principal, middle + radius);
      range.largest_relative_energy = std::max(range.largest_relative_energy, samples.energy[row] / stiffness);
    }
  }
  return range;
}

}  // namespace supple::training
