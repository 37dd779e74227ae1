#include "calibration_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "supple/base/error.h"
#include "supple/base/random.h"
#include "supple/base/threads.h"
#include "supple/neural/error_features.h"
#include "supple/neural/evaluator.h"
#include "supple/training/model_errors.h"

namespace supple::training {
namespace {

/// Designs that trained say where errors are, not how large they are: more of them change nothing.
constexpr std::size_t most_trained_designs = 600;
constexpr int fewest_held_designs = 4;
constexpr std::size_t fewest_states = 50;

/// One state of one quantity.
struct Observation {
  Eigen::VectorXd features;
  double error = 0;
  double relative = 0;
  bool in_box = false;
};
using Observations = std::array<std::vector<Observation>, neural::all_quantities.size()>;

std::vector<Observation>& of(Observations& all, neural::Quantity quantity) {
  return all[static_cast<std::size_t>(quantity)];
}

/// Direction of the material along which a stress pulls that is uniaxial but for rounding.
double direction_of(const Eigen::Vector3d& stress) {
  const double angle = 0.5 * std::atan2(2 * stress[2], stress[0] - stress[1]);
  // Of the two principal stresses the other may be the one that is not zero.
  return stress[0] + stress[1] < 0 ? angle + std::numbers::pi / 2 : angle;
}

class DesignStates {
 public:
  DesignStates(const neural::Model& model, const neural::Evaluator& evaluator, const Samples& samples,
               const SampledDesign& sampled)
      : model_(model),
        evaluator_(evaluator),
        samples_(samples),
        sampled_(sampled),
        design_(evaluator.design(sampled.parameters)),
        rest_(at(Eigen::Vector3d::Zero())),
        features_(neural::design_features(model.network, sampled.parameters, design_.rest_stiffness(), rest_.tangent)) {
  }

  void observe(int row, bool uniaxial, Observations& found) {
    const Eigen::Vector3d strain = samples_.strain.col(row);
    const Eigen::Vector3d exact = samples_.stress.col(row);
    const auto point = at(strain);
    const double error = (point.stress - exact).norm();
    of(found, neural::Quantity::stress_at_strain)
        .push_back({neural::strain_features(features_, strain, point.energy_density, point.stress),
                    error / point.stress.norm(), error / exact.norm(), in_box(strain, point.energy_density)});
    if (uniaxial) observe_equilibrium(row, strain, exact, found);
  }

 private:
  neural::UniaxialPoint at(const Eigen::Vector3d& strain) {
    evaluator_.evaluate(design_, strain, neural::Order::tangent, workspace_, evaluation_);
    return {evaluation_.energy_density[0], evaluation_.stress.col(0),
            neural::symmetric_matrix(evaluation_.tangent.col(0))};
  }

  bool in_box(const Eigen::Vector3d& strain, double energy_density) const {
    return neural::in_range(model_, sampled_.parameters, strain, energy_density, design_.rest_stiffness());
  }

  void observe_equilibrium(int row, const Eigen::Vector3d& strain, const Eigen::Vector3d& exact, Observations& found) {
    const neural::UniaxialFrame frame(direction_of(exact));
    // d^T E d: what the frame's load does work on.
    const Eigen::Vector3d dyad = frame.along.cwiseProduct(Eigen::Vector3d(1, 1, 0.5));
    const double given = dyad.dot(strain);
    neural::UniaxialNewton newton(frame);
    newton.start_from_rest(rest_);
    newton.go_to(given);
    while (newton.working()) newton.receive(at(newton.trial()));
    if (!newton.converged()) return;
    const auto& point = newton.point();
    const auto features = neural::uniaxial_features(features_, frame, given, newton.strain(), point);
    const bool inside = in_box(newton.strain(), point.energy_density);
    const auto slopes = neural::path_slopes(frame, point.tangent);
    const auto simulated = neural::path_slopes(frame, neural::symmetric_matrix(samples_.tangent.col(row)));
    const auto add = [&](neural::Quantity quantity, double value, double truth) {
      const double error = std::abs(value - truth);
      const bool plain = quantity == neural::Quantity::poisson;
      of(found, quantity)
          .push_back(
              {features, plain ? error : error / std::abs(value), plain ? error : error / std::abs(truth), inside});
    };
    add(neural::Quantity::stress, frame.directional(point.stress), frame.directional(exact));
    add(neural::Quantity::stiffness, slopes.stiffness, simulated.stiffness);
    add(neural::Quantity::poisson, slopes.poisson, simulated.poisson);
  }

  const neural::Model& model_;
  const neural::Evaluator& evaluator_;
  const Samples& samples_;
  const SampledDesign& sampled_;
  neural::Evaluator::Design design_;
  neural::Evaluator::Workspace workspace_;
  neural::Evaluation evaluation_;
  neural::UniaxialPoint rest_;
  neural::DesignFeatures features_;
};

dataset::LoadKind load_of(const ModelData& data, const SampleSource& source) {
  auto position = static_cast<std::size_t>(source.design);
  const auto* set = &data.data;
  for (std::size_t i = 0; position >= set->designs.size(); ++i) {
    position -= set->designs.size();
    set = &data.more[i];
  }
  const auto& design = set->designs[position];
  const auto& row = design.rows[static_cast<std::size_t>(source.row)];
  return design.paths[static_cast<std::size_t>(row.path)].kind;
}

/// For each sampled design its fold, -1 where it trained, -2 where it is left out.
std::vector<int> folds_of(const Samples& samples, const Split& parts, int most_folds, CalibrationStates& states) {
  std::vector<bool> held_row(static_cast<std::size_t>(samples.rows()), false);
  for (const auto* rows : {&parts.test, &parts.validation})
    for (const int row : *rows) held_row[static_cast<std::size_t>(row)] = true;
  std::vector<int> fold(samples.designs.size(), -2);
  std::vector<std::size_t> held;
  std::vector<std::size_t> trained;
  for (std::size_t d = 0; d < samples.designs.size(); ++d)
    (held_row[static_cast<std::size_t>(samples.designs[d].first)] ? held : trained).push_back(d);
  if (held.size() < fewest_held_designs)
    throw Error("training.no_samples",
                fmt::format("A calibration needs {} designs that training has not seen; there are {}.",
                            fewest_held_designs, held.size()));
  RandomStream random("folds of a calibration", 1);
  for (std::size_t i = held.size() - 1; i > 0; --i)
    std::swap(held[i], held[static_cast<std::size_t>(random.below(static_cast<int>(i) + 1))]);
  states.held_designs = static_cast<int>(held.size());
  states.folds = std::min(most_folds, states.held_designs);
  for (std::size_t i = 0; i < held.size(); ++i) fold[held[i]] = static_cast<int>(i) % states.folds;
  const std::size_t step = std::max<std::size_t>(1, trained.size() / most_trained_designs);
  for (std::size_t i = 0; i < trained.size(); i += step) fold[trained[i]] = -1;
  return fold;
}

}  // namespace

CalibrationStates calibration_states(const neural::Model& model, const ModelData& data, int most_folds,
                                     const CancellationToken& cancellation) {
  const ModelSamples model_samples = samples_of(model, data);
  const auto& samples = model_samples.samples;
  const auto& parts = model_samples.split;
  CalibrationStates states;
  const auto fold = folds_of(samples, parts, most_folds, states);
  const neural::Evaluator evaluator(model.network);
  std::vector<Observations> found(samples.designs.size());
  parallel_for(static_cast<int>(samples.designs.size()), [&](int index) {
    const auto d = static_cast<std::size_t>(index);
    if (fold[d] < -1) return;
    cancellation.throw_if_requested();
    const auto& sampled = samples.designs[d];
    DesignStates design(model, evaluator, samples, sampled);
    for (int row = sampled.first; row < sampled.first + sampled.count; ++row) {
      if (samples.energy[row] < least_judged_energy) continue;
      const auto load = load_of(data, samples.source[static_cast<std::size_t>(row)]);
      design.observe(row, load == dataset::LoadKind::uniaxial, found[d]);
    }
  });
  for (const auto quantity : neural::all_quantities) {
    auto& result = states.of[static_cast<std::size_t>(quantity)];
    std::vector<const Observation*> kept;
    std::size_t held = 0;
    for (std::size_t d = 0; d < found.size(); ++d) {
      for (const auto& observation : of(found[d], quantity)) {
        if (!observation.features.allFinite() || !std::isfinite(observation.error)) continue;
        if (!observation.in_box) {
          if (fold[d] >= 0) result.out_of_box.push_back(observation.relative);
          continue;
        }
        kept.push_back(&observation);
        result.observed.fold.push_back(fold[d]);
        result.observed.design.push_back(static_cast<int>(d));
        result.relative.push_back(observation.relative);
        held += fold[d] >= 0 ? 1U : 0U;
      }
    }
    if (held < fewest_states)
      throw Error("training.no_samples",
                  fmt::format("A calibration of the {} needs {} states of designs that training has not seen; there "
                              "are {}.",
                              to_string(quantity), fewest_states, held));
    const auto n = static_cast<Eigen::Index>(kept.size());
    result.observed.features.resize(n, kept.front()->features.size());
    result.observed.error.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& observation = *kept[static_cast<std::size_t>(i)];
      result.observed.features.row(i) = observation.features.transpose();
      result.observed.error[i] = observation.error;
    }
  }
  return states;
}

}  // namespace supple::training
