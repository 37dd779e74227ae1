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

/// Designs on which the network was trained show how errors depend on the state, but not how large they are. More of
/// them do not improve the fit.
constexpr std::size_t max_trained_designs = 600;
constexpr int min_held_out_designs = 4;
constexpr std::size_t min_states = 50;

/// The error of one quantity at one state.
struct Observation {
  Eigen::VectorXd features;
  double error = 0;           ///< as in neural::Quantity
  double relative_error = 0;  ///< relative to the simulated value; absolute for Poisson's ratio
  bool in_box = false;        ///< within the range of training (neural::in_range)
};
using Observations = std::array<std::vector<Observation>, neural::all_quantities.size()>;

std::vector<Observation>& observations_of(Observations& all, neural::Quantity quantity) {
  return all[static_cast<std::size_t>(quantity)];
}

/// Direction of a uniaxial load in the material, from a stress whose other principal value is 0 but for rounding.
double load_direction(const Eigen::Vector3d& stress) {
  const double angle = 0.5 * std::atan2(2 * stress[2], stress[0] - stress[1]);
  // The angle is that of the greater principal stress, which is the zero one in compression.
  return stress[0] + stress[1] < 0 ? angle + std::numbers::pi / 2 : angle;
}

/// Evaluates the network at the simulated states of one design.
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

  void observe(int row, bool uniaxial, Observations& observed) {
    const Eigen::Vector3d strain = samples_.strain.col(row);
    const Eigen::Vector3d simulated_stress = samples_.stress.col(row);
    const auto response = at(strain);
    const double error = (response.stress - simulated_stress).norm();
    observations_of(observed, neural::Quantity::stress_at_strain)
        .push_back({neural::strain_features(features_, strain, response.energy_density, response.stress),
                    error / response.stress.norm(), error / simulated_stress.norm(),
                    in_box(strain, response.energy_density)});
    if (uniaxial) observe_equilibrium(row, strain, simulated_stress, observed);
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

  void observe_equilibrium(int row, const Eigen::Vector3d& strain, const Eigen::Vector3d& simulated_stress,
                           Observations& observed) {
    const neural::UniaxialFrame frame(load_direction(simulated_stress));
    // The axial strain d^T E d is work-conjugate to the stress along the load.
    const Eigen::Vector3d dyad = frame.along.cwiseProduct(Eigen::Vector3d(1, 1, 0.5));
    const double axial_strain = dyad.dot(strain);
    neural::UniaxialNewton newton(frame);
    newton.start_from_rest(rest_);
    newton.go_to(axial_strain);
    while (newton.working()) newton.receive(at(newton.trial()));
    if (!newton.converged()) return;
    const auto& response = newton.point();
    const auto features = neural::uniaxial_features(features_, frame, axial_strain, newton.strain(), response);
    const bool inside = in_box(newton.strain(), response.energy_density);
    const auto slopes = neural::path_slopes(frame, response.tangent);
    const auto simulated_slopes = neural::path_slopes(frame, neural::symmetric_matrix(samples_.tangent.col(row)));
    const auto add = [&](neural::Quantity quantity, double value, double truth) {
      const double error = std::abs(value - truth);
      const bool is_absolute = quantity == neural::Quantity::poisson;
      observations_of(observed, quantity)
          .push_back({features, is_absolute ? error : error / std::abs(value),
                      is_absolute ? error : error / std::abs(truth), inside});
    };
    add(neural::Quantity::stress, frame.directional(response.stress), frame.directional(simulated_stress));
    add(neural::Quantity::stiffness, slopes.stiffness, simulated_slopes.stiffness);
    add(neural::Quantity::poisson, slopes.poisson, simulated_slopes.poisson);
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
  auto index = static_cast<std::size_t>(source.design);
  const auto* set = &data.data;
  for (std::size_t i = 0; index >= set->designs.size(); ++i) {
    index -= set->designs.size();
    set = &data.more[i];
  }
  const auto& design = set->designs[index];
  const auto& row = design.rows[static_cast<std::size_t>(source.row)];
  return design.paths[static_cast<std::size_t>(row.path)].kind;
}

/// Fold of designs that are not part of a calibration.
constexpr int excluded = -2;

/// Distributes designs over folds at random. Returns the number of folds.
int assign_folds(std::vector<std::size_t> designs, int max_folds, std::vector<int>& fold) {
  RandomStream random("folds of a calibration", 1);
  for (std::size_t i = designs.size(); i > 1; --i)
    std::swap(designs[i - 1], designs[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
  const int folds = std::min(max_folds, static_cast<int>(designs.size()));
  for (std::size_t i = 0; i < designs.size(); ++i) fold[designs[i]] = static_cast<int>(i) % folds;
  return folds;
}

void require_designs(std::size_t designs) {
  if (designs < static_cast<std::size_t>(min_held_out_designs))
    throw Error("training.no_samples",
                fmt::format("A calibration needs {} designs that training has not seen; there are {}.",
                            min_held_out_designs, designs));
}

/// The fold of each sampled design, or -1 for a design on which the network was trained. Held-out designs are excluded
/// if reference designs replace them.
std::vector<int> folds_of(const Samples& samples, const Split& parts, int max_folds, bool has_references,
                          CalibrationStates& states) {
  std::vector<bool> is_held_out(static_cast<std::size_t>(samples.rows()), false);
  for (const auto* rows : {&parts.test, &parts.validation})
    for (const int row : *rows) is_held_out[static_cast<std::size_t>(row)] = true;
  std::vector<int> fold(samples.designs.size(), excluded);
  std::vector<std::size_t> held_out;
  std::vector<std::size_t> trained;
  for (std::size_t d = 0; d < samples.designs.size(); ++d)
    (is_held_out[static_cast<std::size_t>(samples.designs[d].first)] ? held_out : trained).push_back(d);
  if (!has_references) {
    require_designs(held_out.size());
    states.held_out_designs = static_cast<int>(held_out.size());
    states.folds = assign_folds(std::move(held_out), max_folds, fold);
  }
  const std::size_t step = std::max<std::size_t>(1, trained.size() / max_trained_designs);
  for (std::size_t i = 0; i < trained.size(); i += step) fold[trained[i]] = -1;
  return fold;
}

/// Combines data sets of reference designs. Throws "dataset.different_recipe" if they are of another family or solid
/// than `data`.
ModelData combined(const std::vector<dataset::Dataset>& sets, const ModelData& data) {
  for (const auto& set : sets) check_same_solid(data, set);
  return {sets.front(), {sets.begin() + 1, sets.end()}, {}};
}

/// The observations at all samples of `data`, in parallel over the designs.
std::vector<Observations> observe_all(const neural::Model& model, const neural::Network& network, const ModelData& data,
                                      const Samples& samples, const std::vector<int>& fold,
                                      const CancellationToken& cancellation) {
  const neural::Evaluator evaluator(network);
  std::vector<Observations> observations(samples.designs.size());
  parallel_for(static_cast<int>(samples.designs.size()), [&](int index) {
    const auto d = static_cast<std::size_t>(index);
    if (fold[d] == excluded) return;
    cancellation.throw_if_requested();
    const auto& sampled = samples.designs[d];
    DesignStates design(model, evaluator, samples, sampled);
    for (int row = sampled.first; row < sampled.first + sampled.count; ++row) {
      if (samples.energy[row] < min_evaluated_energy) continue;
      const auto load = load_of(data, samples.source[static_cast<std::size_t>(row)]);
      design.observe(row, load == dataset::LoadKind::uniaxial, observations[d]);
    }
  });
  return observations;
}

/// Appends the observations of designs, which are numbered from `first_design` on.
void append(const std::vector<Observations>& observations, const std::vector<int>& fold, int first_design,
            CalibrationStates::AllStates& states) {
  for (const auto quantity : neural::all_quantities) {
    const auto q = static_cast<std::size_t>(quantity);
    auto& result = states[q];
    std::vector<const Observation*> retained;
    for (std::size_t d = 0; d < observations.size(); ++d) {
      for (const auto& observation : observations[d][q]) {
        if (!observation.features.allFinite() || !std::isfinite(observation.error)) continue;
        if (!observation.in_box) {
          if (fold[d] >= 0) result.out_of_box.push_back(observation.relative_error);
          continue;
        }
        retained.push_back(&observation);
        result.observed.fold.push_back(fold[d]);
        result.observed.design.push_back(first_design + static_cast<int>(d));
        result.relative_error.push_back(observation.relative_error);
      }
    }
    if (retained.empty()) continue;
    const Eigen::Index previous = result.observed.error.size();
    const auto n = static_cast<Eigen::Index>(retained.size());
    result.observed.features.conservativeResize(previous + n, retained.front()->features.size());
    result.observed.error.conservativeResize(previous + n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& observation = *retained[static_cast<std::size_t>(i)];
      result.observed.features.row(previous + i) = observation.features.transpose();
      result.observed.error[previous + i] = observation.error;
    }
  }
}

void require_states(const CalibrationStates::AllStates& states) {
  for (const auto quantity : neural::all_quantities) {
    const auto& folds = states[static_cast<std::size_t>(quantity)].observed.fold;
    const auto held_out =
        static_cast<std::size_t>(std::count_if(folds.begin(), folds.end(), [](int f) { return f >= 0; }));
    if (held_out < min_states)
      throw Error("training.no_samples",
                  fmt::format("A calibration of the {} needs {} states of designs that training has not seen; there "
                              "are {}.",
                              to_string(quantity), min_states, held_out));
  }
}

/// Appends the states of all designs of some reference data, all of them held out. Returns the number of folds, and
/// their number of designs in `designs`.
int add_references(const neural::Model& model, const ModelData& data, const std::vector<dataset::Dataset>& sets,
                   const SampleOptions& options, int max_folds, int first_design, int& designs,
                   CalibrationStates::AllStates& states, const CancellationToken& cancellation) {
  const ModelData own = combined(sets, data);
  const Samples samples = read_samples(own, options);
  require_designs(samples.designs.size());
  std::vector<std::size_t> all(samples.designs.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<int> fold(samples.designs.size());
  const int folds = assign_folds(std::move(all), max_folds, fold);
  designs = static_cast<int>(samples.designs.size());
  append(observe_all(model, model.network, own, samples, fold, cancellation), fold, first_design, states);
  return folds;
}

}  // namespace

CalibrationStates calibration_states(const neural::Model& model, const ModelData& data, const ReferenceData& references,
                                     int max_folds, const CancellationToken& cancellation) {
  const bool has_references = !references.drawn.empty();
  const ModelSamples own = samples_of(model, data);
  const auto& samples = own.samples;
  CalibrationStates states;
  const auto fold = folds_of(samples, own.split, max_folds, has_references, states);
  // The data have the error of their mesh. Therefore they are compared with the network without its correction.
  append(observe_all(model, neural::without_mesh_correction(model.network), data, samples, fold, cancellation), fold, 0,
         states.given);
  const auto designs = static_cast<int>(samples.designs.size());
  if (has_references)
    states.folds = add_references(model, data, references.drawn, own.options, max_folds, designs,
                                  states.held_out_designs, states.given, cancellation);
  require_states(states.given);
  if (references.searched.empty()) return states;
  states.searched_folds =
      add_references(model, data, references.searched, own.options, max_folds, designs + states.held_out_designs,
                     states.searched_designs, states.searched, cancellation);
  require_states(states.searched);
  return states;
}

}  // namespace supple::training
