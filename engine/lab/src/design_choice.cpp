#include "supple/lab/design_choice.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "supple/base/sobol.h"
#include "supple/neural/evaluator.h"
#include "supple/tiling/structure.h"

namespace supple::lab {
namespace {

/// Disagreements above this one count as it does: networks that are wrong by half are as useless as worse ones.
constexpr double max_disagreement = 0.5;

/// Designs in coordinates in which the family's box is the unit cube.
class UnitBox {
 public:
  explicit UnitBox(const std::vector<tiling::Parameter>& bounds) : bounds_(bounds) {}

  std::vector<double> parameters_at(std::span<const double> point) const {
    std::vector<double> parameters;
    for (std::size_t k = 0; k < bounds_.size(); ++k)
      parameters.push_back(bounds_[k].lower + point[k] * (bounds_[k].upper - bounds_[k].lower));
    return parameters;
  }

  double squared_distance(std::span<const double> a, std::span<const double> b) const {
    double sum = 0;
    for (std::size_t k = 0; k < bounds_.size(); ++k) {
      const double difference = (a[k] - b[k]) / (bounds_[k].upper - bounds_[k].lower);
      sum += difference * difference;
    }
    return sum;
  }

 private:
  const std::vector<tiling::Parameter>& bounds_;
};

struct SimulatedDesign {
  std::vector<double> parameters;
  Eigen::Matrix3Xd strains;  ///< (E_xx, E_yy, 2 E_xy)
};

std::vector<SimulatedDesign> simulated_designs(std::span<const dataset::Dataset> data) {
  std::vector<SimulatedDesign> designs;
  for (const auto& set : data) {
    for (const auto& design : set.designs) {
      if (design.rows.empty()) continue;
      Eigen::Matrix3Xd strains(3, static_cast<long>(design.rows.size()));
      for (std::size_t i = 0; i < design.rows.size(); ++i) {
        const auto& strain = design.rows[i].green_strain;
        strains.col(static_cast<long>(i)) << strain[0], strain[1], 2 * strain[2];
      }
      designs.push_back({design.parameters, std::move(strains)});
    }
  }
  return designs;
}

struct Candidate {
  std::vector<double> parameters;
  double score = 0;
};

/// Mean over the strains of how far stresses are from their mean over the members, relative to that mean.
double disagreement(std::span<const neural::Evaluator> members, const std::vector<double>& parameters,
                    const Eigen::Matrix3Xd& strains) {
  std::vector<Eigen::Matrix3Xd> stresses;
  Eigen::Matrix3Xd mean = Eigen::Matrix3Xd::Zero(3, strains.cols());
  for (const auto& member : members) {
    stresses.push_back(member.evaluate(member.design(parameters), strains, neural::Order::stress).stress);
    mean += stresses.back() / static_cast<double>(members.size());
  }
  double sum = 0;
  for (long i = 0; i < strains.cols(); ++i) {
    double squares = 0;
    for (const auto& stress : stresses) squares += (stress.col(i) - mean.col(i)).squaredNorm();
    const double size = std::max(mean.col(i).norm(), std::numeric_limits<double>::min());
    const double relative = std::sqrt(squares / static_cast<double>(members.size())) / size;
    // The condition is negated, so that a stress that is not finite counts as the largest disagreement.
    sum += !(relative < max_disagreement) ? max_disagreement : relative;
  }
  return sum / static_cast<double>(strains.cols());
}

const SimulatedDesign& nearest(const std::vector<SimulatedDesign>& designs, const UnitBox& box,
                               const std::vector<double>& parameters) {
  const auto distance = [&](const SimulatedDesign& design) {
    return box.squared_distance(design.parameters, parameters);
  };
  return *std::min_element(designs.begin(), designs.end(),
                           [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
}

}  // namespace

std::vector<std::vector<double>> choose_designs(const tiling::Family& family, std::span<const neural::Model> members,
                                                std::span<const dataset::Dataset> data, const ChoiceOptions& options) {
  const auto designs = simulated_designs(data);
  if (designs.empty()) return {};
  std::vector<neural::Evaluator> evaluators;
  for (const auto& member : members) evaluators.emplace_back(member.network);
  const UnitBox box(family.parameters);
  const SobolSequence sequence("lab.candidates", options.seed);
  std::vector<Candidate> candidates;
  for (int i = 0; i < options.candidates; ++i) {
    const auto point = sequence.point(options.first + static_cast<std::uint32_t>(i));
    auto parameters = box.parameters_at(point);
    if (!tiling::can_be_built(family, parameters)) continue;
    const double score = disagreement(evaluators, parameters, nearest(designs, box, parameters).strains);
    candidates.push_back({std::move(parameters), score});
  }
  // The distance of neighbours where designs of this number are spread evenly.
  const auto count = static_cast<double>(designs.size()) + options.designs;
  const double spacing = std::pow(count, -1 / static_cast<double>(family.parameters.size()));
  std::vector<std::vector<double>> chosen;
  while (static_cast<int>(chosen.size()) < options.designs && chosen.size() < candidates.size()) {
    const auto best = std::max_element(candidates.begin(), candidates.end(),
                                       [](const auto& a, const auto& b) { return a.score < b.score; });
    if (best->score <= 0) break;
    chosen.push_back(best->parameters);
    for (auto& candidate : candidates) {
      const double distance = box.squared_distance(candidate.parameters, chosen.back()) / (spacing * spacing);
      candidate.score *= -std::expm1(-distance);
    }
  }
  return chosen;
}

}  // namespace supple::lab
