#include "supple/training/model_training.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iterator>
#include <set>

#include "supple/base/error.h"
#include "supple/tiling/symmetry.h"
#include "supple/training/model_errors.h"
#include "supple/training/tile_geometry.h"
#include "training_set.h"

namespace supple::training {
namespace {

/// What a rotation or reflection R makes of strains: E -> R E R^T.
Eigen::Matrix3d strain_map(const Eigen::Matrix2d& r) {
  Eigen::Matrix3d map;
  for (int k = 0; k < 3; ++k) {
    Eigen::Matrix2d unit = Eigen::Matrix2d::Zero();
    if (k < 2)
      unit(k, k) = 1;
    else
      unit(0, 1) = unit(1, 0) = 0.5;
    const Eigen::Matrix2d image = r * unit * r.transpose();
    map.col(k) << image(0, 0), image(1, 1), 2 * image(0, 1);
  }
  return map;
}

/// The versions of the engine that computed the designs.
std::string engines_of(const ModelData& data) {
  std::set<std::string> engines;
  for (const auto& design : data.data.designs) engines.insert(design.engine);
  for (const auto& set : data.more)
    for (const auto& design : set.designs) engines.insert(design.engine);
  std::string text;
  for (const auto& engine : engines) text += (text.empty() ? "" : ", ") + engine;
  return text;
}

/// The coefficients of a polynomial of degree 2 (neural::Network::mesh_correction) in x, where the given ones are those
/// of the same polynomial in factor * x + shift.
Eigen::MatrixXd with_shifted_argument(const Eigen::MatrixXd& given, const Eigen::ArrayXd& factor,
                                      const Eigen::ArrayXd& shift) {
  if (given.size() == 0) return given;
  const long n = factor.size();
  Eigen::MatrixXd coefficients = given;
  for (long i = 0; i < n; ++i) {
    coefficients.col(0) += shift[i] * given.col(1 + i);
    coefficients.col(1 + i) *= factor[i];
  }
  long at = 1 + n;
  for (long i = 0; i < n; ++i)
    for (long j = i; j < n; ++j, ++at) {
      coefficients.col(0) += shift[i] * shift[j] * given.col(at);
      coefficients.col(1 + i) += factor[i] * shift[j] * given.col(at);
      coefficients.col(1 + j) += factor[j] * shift[i] * given.col(at);
      coefficients.col(at) *= factor[i] * factor[j];
    }
  return coefficients;
}

/// The same function of the parameters with other bounds: mapped parameters are affine functions of each other.
neural::Network with_bounds(neural::Network network, const std::vector<double>& lower,
                            const std::vector<double>& upper) {
  const auto n = static_cast<long>(lower.size());
  const Eigen::Map<const Eigen::ArrayXd> new_lower(lower.data(), n);
  const Eigen::Map<const Eigen::ArrayXd> new_upper(upper.data(), n);
  const Eigen::ArrayXd width = network.upper - network.lower;
  // Old mapped parameters are factor times new ones, plus shift.
  const Eigen::ArrayXd factor = (new_upper - new_lower) / width;
  const Eigen::ArrayXd shift = (new_upper + new_lower - (network.upper + network.lower).array()) / width;
  for (auto* branch : {&network.parameter, &network.stiffness}) {
    if (branch->empty()) continue;
    auto& [weights, bias] = branch->front();
    bias += weights.leftCols(n) * shift.matrix();
    weights.leftCols(n) = weights.leftCols(n) * factor.matrix().asDiagonal();
  }
  network.mesh_correction = with_shifted_argument(network.mesh_correction, factor, shift);
  network.lower = new_lower;
  network.upper = new_upper;
  return network;
}

/// Of the widths: designs are drawn, so that data which end so near to a bound cover it.
constexpr double covered_share = 0.02;

neural::Network narrowed(neural::Network network, const Samples& samples) {
  std::vector<double> lower, upper;
  for (long k = 0; k < network.lower.size(); ++k) {
    const auto of = [k](const SampledDesign& design) { return design.parameters[static_cast<std::size_t>(k)]; };
    const double least = of(*std::ranges::min_element(samples.designs, {}, of));
    const double greatest = of(*std::ranges::max_element(samples.designs, {}, of));
    const double near = covered_share * (network.upper[k] - network.lower[k]);
    lower.push_back(least > network.lower[k] + near ? least : network.lower[k]);
    upper.push_back(greatest < network.upper[k] - near ? greatest : network.upper[k]);
  }
  if (std::ranges::equal(lower, network.lower) && std::ranges::equal(upper, network.upper)) return network;
  return with_bounds(std::move(network), lower, upper);
}

/// Goes on with a model of the family: one whose own test and validation designs are those of the new training, or one
/// that is declared foreign.
void start_from(const ModelOptions& given, const ModelData& data, const std::string& family, const Samples& samples,
                const Split& parts, TrainingOptions& options) {
  const auto& start = *given.start;
  const auto require = [&](bool fine, const char* limit) {
    if (fine) return;
    throw Error("training.different_data",
                fmt::format("The model {} of {} was trained with other designs held out than {} would be now.",
                            start.id, start.family, family),
                {{"start", limit}});
  };
  require(start.family == family, "a model of the same family");
  options.start = start.network;
  // A finished model is narrowed, and a foreign one may be of another range.
  if (!std::ranges::equal(start.network.lower, samples.lower) ||
      !std::ranges::equal(start.network.upper, samples.upper))
    options.start = with_bounds(start.network, samples.lower, samples.upper);
  if (!given.start_is_foreign) {
    const auto theirs = samples_of(start, data).split;
    require(theirs.test == parts.test && theirs.validation == parts.validation,
            "the same data and shares of the split, or --start-foreign");
  }
  options.shape = start.network.shape;
  options.geometry = start.network.geometry;
}

/// What the data make of a model's options.
struct Prepared {
  const tiling::Family& family;
  Samples samples;
  Split parts;
  TrainingOptions training;
  std::vector<RestStiffness> rest;
};

Prepared prepared(const ModelData& data, const ModelOptions& options) {
  const auto& family = tiling::family(data.data.recipe.text("family"));
  Prepared made{family, read_samples(data, options.samples), {}, options.training, {}};
  made.parts = split(made.samples, options.split);
  auto& training = made.training;
  training.shape.parameters = static_cast<int>(made.samples.lower.size());
  if (options.start) {
    start_from(options, data, family.id, made.samples, made.parts, training);
  } else if (options.use_features) {
    training.geometry = tile_geometry(family);
    training.shape.features = static_cast<int>(training.geometry.features.size());
  }
  if (options.use_symmetry) training.symmetries = energy_symmetries(family);
  made.rest = read_rest(data);
  return made;
}

/// The model of a trained network without the provenance of its training: its id, bounds and measured errors.
neural::Model model_of(const Prepared& from, const ModelOptions& options, const neural::Network& network) {
  neural::Model model;
  model.id = options.id;
  if (model.id.empty())
    std::transform(from.family.id.begin(), from.family.id.end(), std::back_inserter(model.id),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  model.family = from.family.id;
  model.network = narrowed(network, from.samples);
  model.strain_range = strain_range(model.network, from.samples, from.parts.training);
  model.design_split = split_errors(model.network, from.samples, from.parts.test);
  model.row_split = split_errors(model.network, from.samples, from.parts.row_test);
  return model;
}

/// Says where a finished model comes from.
void describe_origin(neural::Provenance& provenance, const Prepared& from, const ModelOptions& options,
                     const ModelData& data, double seconds) {
  provenance.data_engine = engines_of(data);
  provenance.rows = static_cast<std::int64_t>(from.parts.training.size());
  provenance.seed = from.training.seed;
  auto described = options;
  described.training = from.training;
  provenance.options = describe(described);
  provenance.training_seconds = seconds;
  if (const auto& start = options.start) {
    provenance.training_seconds += start->provenance.training_seconds;
    int epochs = 0;  // of all trainings before this one
    for (const auto& [name, value] : start->provenance.options)
      if (name == "epochs" || name == "start_epochs") epochs += std::atoi(value.c_str());
    provenance.options.emplace_back("start_epochs", std::to_string(epochs));
    if (options.start_is_foreign) {
      provenance.options.emplace_back("start_model", start->id);
      provenance.options.emplace_back("start_data", start->provenance.data_set);
    }
  }
  if (!from.rest.empty()) provenance.options.emplace_back("rest_designs", std::to_string(from.rest.size()));
  provenance.youngs_modulus = data.data.recipe.number("youngs_modulus");
  provenance.poisson_ratio = data.data.recipe.number("poisson_ratio");
}

}  // namespace

std::vector<EnergySymmetry> energy_symmetries(const tiling::Family& family) {
  std::vector<EnergySymmetry> distinct;
  for (const auto& of_tilings : tiling::symmetries(family)) {
    const EnergySymmetry symmetry{strain_map(of_tilings.operation), of_tilings.linear, of_tilings.constant};
    if (std::none_of(distinct.begin(), distinct.end(), [&](const EnergySymmetry& known) {
          return known.strain.isApprox(symmetry.strain, 1e-9) && known.linear.isApprox(symmetry.linear, 1e-6) &&
                 (known.constant - symmetry.constant).norm() < 1e-6;
        }))
      distinct.push_back(symmetry);
  }
  // The identity, which comes first.
  distinct.erase(distinct.begin());
  return distinct;
}

std::vector<std::pair<std::string, std::string>> describe(const ModelOptions& options) {
  auto all = describe(options.training);
  const auto add = [&](const char* name, const auto& value) { all.emplace_back(name, fmt::format("{}", value)); };
  add("least_energy", options.samples.least_energy);
  add("largest_energy", options.samples.largest_energy);
  add("validation_share", options.split.validation);
  add("test_share", options.split.test);
  add("row_test_share", options.split.row_test);
  add("split_seed", options.split.seed);
  return all;
}

ModelSamples samples_of(const neural::Model& model, const ModelData& data) {
  const auto number = [&](const char* name) {
    for (const auto& [option, value] : model.provenance.options)
      if (option == name) return std::strtod(value.c_str(), nullptr);
    throw Error("file.unreadable", fmt::format("The model {} does not say its {}.", model.id, name));
  };
  const SampleOptions options{number("least_energy"), number("largest_energy")};
  const SplitOptions shares{number("validation_share"), number("test_share"), number("row_test_share"),
                            static_cast<std::int64_t>(number("split_seed"))};
  ModelSamples made{read_samples(data, options), {}, options};
  made.split = split(made.samples, shares);
  // Other designs would be split in another way: some that the model was trained on would then judge it.
  if (static_cast<std::int64_t>(made.split.training.size()) != model.provenance.rows)
    throw Error("training.different_data",
                fmt::format("The model {} was trained on {} states; of this data, its split trains on {}.", model.id,
                            model.provenance.rows, made.split.training.size()),
                {{"data", model.provenance.data_set}});
  return made;
}

neural::Model symmetrized(neural::Model model, const ModelData& data) {
  const auto& family = tiling::family(model.family);
  const auto [samples, parts, chosen] = samples_of(model, data);
  auto& symmetries = model.network.symmetries;
  symmetries.clear();
  // Another network's errors are not this one's.
  model.calibration.reset();
  for (const auto& [strain, linear, constant] : energy_symmetries(family))
    if (strain.determinant() > 0 && linear.isIdentity(1e-6) && constant.norm() < 1e-6) symmetries.push_back(strain);
  if (symmetries.empty())
    throw Error("training.no_symmetry",
                fmt::format("Tilings of the family {} have no rotation but by half a turn.", family.id),
                {{"family", family.id}});
  model.strain_range = strain_range(model.network, samples, parts.training);
  model.design_split = split_errors(model.network, samples, parts.test);
  model.row_split = split_errors(model.network, samples, parts.row_test);
  return model;
}

neural::Model narrowed(neural::Model model, const ModelData& data) {
  model.network = narrowed(std::move(model.network), samples_of(model, data).samples);
  model.calibration.reset();
  return model;
}

ModelResult train_model(const ModelData& data, const std::string& data_name, const std::string& engine,
                        const ModelOptions& options, const std::filesystem::path& checkpoint,
                        const CancellationToken& cancellation, const std::function<void(const EpochReport&)>& report,
                        const std::function<void(const StiffnessReport&)>& stiffness_report) {
  const auto from = prepared(data, options);
  const auto trained =
      train(from.samples, from.parts, from.training, checkpoint, cancellation, report, from.rest, stiffness_report);
  ModelResult result;
  result.history = trained.history;
  result.stiffness = trained.stiffness;
  result.best_epoch = trained.best_epoch;
  result.finished = trained.finished;
  if (!trained.finished) return result;
  result.model = model_of(from, options, trained.network);
  auto& provenance = result.model.provenance;
  provenance.data_set = data_name;
  provenance.engine = engine;
  provenance.designs = static_cast<std::int64_t>(from.samples.designs.size()) - result.model.design_split->designs;
  describe_origin(provenance, from, options, data, trained.history.empty() ? 0 : trained.history.back().seconds);
  provenance.options.emplace_back("device", to_string(trained.device));
  return result;
}

bool export_model_training(const ModelData& data, const ModelOptions& options, const std::filesystem::path& path,
                           const CancellationToken& cancellation,
                           const std::function<void(const StiffnessReport&)>& stiffness_report) {
  const auto from = prepared(data, options);
  return export_training(path, from.samples, from.parts, from.training, from.rest, cancellation, stiffness_report);
}

ModelResult import_model_training(const ModelData& data, const std::string& data_name, const std::string& engine,
                                  const ModelOptions& options, const std::filesystem::path& path) {
  const auto from = prepared(data, options);
  check(from.training, from.samples);
  const auto trained = read_trained(path, from.samples, from.parts, from.training, from.rest);
  ModelResult result;
  result.finished = true;
  result.model = model_of(from, options, trained.network);
  auto& provenance = result.model.provenance;
  provenance.data_set = data_name;
  provenance.engine = engine;
  provenance.designs = static_cast<std::int64_t>(from.samples.designs.size()) - result.model.design_split->designs;
  describe_origin(provenance, from, options, data, trained.seconds);
  for (const auto& [name, value] : trained.options) {
    const auto same = std::ranges::find(provenance.options, name, &std::pair<std::string, std::string>::first);
    if (same == provenance.options.end())
      provenance.options.emplace_back(name, value);
    else
      same->second = value;
  }
  return result;
}

}  // namespace supple::training
