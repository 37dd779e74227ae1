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

/// What keeps a design out of a calibration.
constexpr int left_out = -2;

/// Deals designs into folds at random; returns their number.
int deal(std::vector<std::size_t> designs, int most_folds, std::vector<int>& fold) {
  RandomStream random("folds of a calibration", 1);
  for (std::size_t i = designs.size(); i > 1; --i)
    std::swap(designs[i - 1], designs[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
  const int folds = std::min(most_folds, static_cast<int>(designs.size()));
  for (std::size_t i = 0; i < designs.size(); ++i) fold[designs[i]] = static_cast<int>(i) % folds;
  return folds;
}

void require_designs(std::size_t designs) {
  if (designs < static_cast<std::size_t>(fewest_held_designs))
    throw Error("training.no_samples",
                fmt::format("A calibration needs {} designs that training has not seen; there are {}.",
                            fewest_held_designs, designs));
}

/// For each sampled design of the data its fold, -1 where it trained. Held-out designs are left out where references
/// take their place.
std::vector<int> folds_of(const Samples& samples, const Split& parts, int most_folds, bool has_references,
                          CalibrationStates& states) {
  std::vector<bool> held_row(static_cast<std::size_t>(samples.rows()), false);
  for (const auto* rows : {&parts.test, &parts.validation})
    for (const int row : *rows) held_row[static_cast<std::size_t>(row)] = true;
  std::vector<int> fold(samples.designs.size(), left_out);
  std::vector<std::size_t> held;
  std::vector<std::size_t> trained;
  for (std::size_t d = 0; d < samples.designs.size(); ++d)
    (held_row[static_cast<std::size_t>(samples.designs[d].first)] ? held : trained).push_back(d);
  if (!has_references) {
    require_designs(held.size());
    states.held_designs = static_cast<int>(held.size());
    states.folds = deal(std::move(held), most_folds, fold);
  }
  const std::size_t step = std::max<std::size_t>(1, trained.size() / most_trained_designs);
  for (std::size_t i = 0; i < trained.size(); i += step) fold[trained[i]] = -1;
  return fold;
}

/// Data sets of references as data of their own.
ModelData together(const std::vector<dataset::Dataset>& sets, const ModelData& data) {
  for (const auto& set : sets) check_same_solid(data, set);
  return {sets.front(), {sets.begin() + 1, sets.end()}, {}};
}

/// The observations at all samples of some data.
std::vector<Observations> observations(const neural::Model& model, const neural::Network& network,
                                       const ModelData& data, const Samples& samples, const std::vector<int>& fold,
                                       const CancellationToken& cancellation) {
  const neural::Evaluator evaluator(network);
  std::vector<Observations> found(samples.designs.size());
  parallel_for(static_cast<int>(samples.designs.size()), [&](int index) {
    const auto d = static_cast<std::size_t>(index);
    if (fold[d] == left_out) return;
    cancellation.throw_if_requested();
    const auto& sampled = samples.designs[d];
    DesignStates design(model, evaluator, samples, sampled);
    for (int row = sampled.first; row < sampled.first + sampled.count; ++row) {
      if (samples.energy[row] < least_judged_energy) continue;
      const auto load = load_of(data, samples.source[static_cast<std::size_t>(row)]);
      design.observe(row, load == dataset::LoadKind::uniaxial, found[d]);
    }
  });
  return found;
}

/// Appends what was observed of designs, whose numbers begin with `first_design`.
void append(const std::vector<Observations>& found, const std::vector<int>& fold, int first_design,
            CalibrationStates::Quantities& to) {
  for (const auto quantity : neural::all_quantities) {
    const auto q = static_cast<std::size_t>(quantity);
    auto& result = to[q];
    std::vector<const Observation*> kept;
    for (std::size_t d = 0; d < found.size(); ++d) {
      for (const auto& observation : found[d][q]) {
        if (!observation.features.allFinite() || !std::isfinite(observation.error)) continue;
        if (!observation.in_box) {
          if (fold[d] >= 0) result.out_of_box.push_back(observation.relative);
          continue;
        }
        kept.push_back(&observation);
        result.observed.fold.push_back(fold[d]);
        result.observed.design.push_back(first_design + static_cast<int>(d));
        result.relative.push_back(observation.relative);
      }
    }
    if (kept.empty()) continue;
    const Eigen::Index before = result.observed.error.size();
    const auto n = static_cast<Eigen::Index>(kept.size());
    result.observed.features.conservativeResize(before + n, kept.front()->features.size());
    result.observed.error.conservativeResize(before + n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& observation = *kept[static_cast<std::size_t>(i)];
      result.observed.features.row(before + i) = observation.features.transpose();
      result.observed.error[before + i] = observation.error;
    }
  }
}

void require_states(const CalibrationStates::Quantities& states) {
  for (const auto quantity : neural::all_quantities) {
    const auto& folds = states[static_cast<std::size_t>(quantity)].observed.fold;
    const auto held = static_cast<std::size_t>(std::count_if(folds.begin(), folds.end(), [](int f) { return f >= 0; }));
    if (held < fewest_states)
      throw Error("training.no_samples",
                  fmt::format("A calibration of the {} needs {} states of designs that training has not seen; there "
                              "are {}.",
                              to_string(quantity), fewest_states, held));
  }
}

/// All designs of some references, each of them held out. Returns the number of folds.
int add_references(const neural::Model& model, const ModelData& data, const std::vector<dataset::Dataset>& sets,
                   const SampleOptions& options, int most_folds, int first_design, int& designs,
                   CalibrationStates::Quantities& to, const CancellationToken& cancellation) {
  const ModelData own = together(sets, data);
  const Samples samples = read_samples(own, options);
  require_designs(samples.designs.size());
  std::vector<std::size_t> all(samples.designs.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<int> fold(samples.designs.size());
  const int folds = deal(std::move(all), most_folds, fold);
  designs = static_cast<int>(samples.designs.size());
  append(observations(model, model.network, own, samples, fold, cancellation), fold, first_design, to);
  return folds;
}

}  // namespace

CalibrationStates calibration_states(const neural::Model& model, const ModelData& data, const References& references,
                                     int most_folds, const CancellationToken& cancellation) {
  const bool has_references = !references.drawn.empty();
  const ModelSamples own = samples_of(model, data);
  const auto& samples = own.samples;
  CalibrationStates states;
  const auto fold = folds_of(samples, own.split, most_folds, has_references, states);
  // The data have the error of their mesh: they are compared with the network that they have taught.
  append(observations(model, neural::as_trained(model.network), data, samples, fold, cancellation), fold, 0, states.of);
  const auto designs = static_cast<int>(samples.designs.size());
  if (has_references)
    states.folds = add_references(model, data, references.drawn, own.options, most_folds, designs, states.held_designs,
                                  states.of, cancellation);
  require_states(states.of);
  if (references.searched.empty()) return states;
  states.searched_folds =
      add_references(model, data, references.searched, own.options, most_folds, designs + states.held_designs,
                     states.searched_designs, states.searched, cancellation);
  require_states(states.searched);
  return states;
}

}  // namespace supple::training
