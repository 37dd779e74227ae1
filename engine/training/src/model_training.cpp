#include "supple/training/model_training.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <set>

#include "supple/base/error.h"
#include "supple/tiling/definition_text.h"
#include "supple/tiling/symmetry.h"
#include "supple/training/model_errors.h"
#include "supple/training/tile_geometry.h"
#include "training_set.h"

namespace supple::training {
namespace {

/// The matrix by which a rotation or reflection R transforms strains (E_xx, E_yy, 2 E_xy): E -> R E R^T.
Eigen::Matrix3d strain_transformation(const Eigen::Matrix2d& r) {
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

/// Substitutes factor * x + shift for the argument of a polynomial of degree 2 (neural::Network::mesh_correction), and
/// returns its coefficients in x.
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

/// The network with other parameter bounds, as the same function of the parameters. The first layers absorb the change,
/// because mapped parameters for different bounds are affine functions of each other.
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

/// Data cover a bound if they reach to within this fraction of the width of the box. Designs are sampled, so that the
/// outermost one lies a little within the bound.
constexpr double covered_fraction = 0.02;

neural::Network narrowed(neural::Network network, const Samples& samples) {
  std::vector<double> lower, upper;
  for (long k = 0; k < network.lower.size(); ++k) {
    const auto parameter = [k](const SampledDesign& design) { return design.parameters[static_cast<std::size_t>(k)]; };
    const double data_min = parameter(*std::ranges::min_element(samples.designs, {}, parameter));
    const double data_max = parameter(*std::ranges::max_element(samples.designs, {}, parameter));
    const double margin = covered_fraction * (network.upper[k] - network.lower[k]);
    lower.push_back(data_min > network.lower[k] + margin ? data_min : network.lower[k]);
    upper.push_back(data_max < network.upper[k] - margin ? data_max : network.upper[k]);
  }
  if (std::ranges::equal(lower, network.lower) && std::ranges::equal(upper, network.upper)) return network;
  return with_bounds(std::move(network), lower, upper);
}

/// Sets the network with which training begins to that of another model of the family. Its test and validation designs
/// must be those of the new training unless it is declared foreign.
void start_from(const ModelOptions& model_options, const ModelData& data, const std::string& family,
                const std::string& definition, const Samples& samples, const Split& parts, TrainingOptions& options) {
  const auto& start = *model_options.start;
  const auto require = [&](bool is_met, const char* requirement) {
    if (is_met) return;
    throw Error("training.different_data",
                fmt::format("The model {} of {} was trained with other designs held out than {} would be now.",
                            start.id, start.family, family),
                {{"start", requirement}});
  };
  require(start.family == family && start.definition == definition, "a model of the same family");
  options.start = start.network;
  // The bounds differ if the model was narrowed, or if it is foreign.
  if (!std::ranges::equal(start.network.lower, samples.lower) ||
      !std::ranges::equal(start.network.upper, samples.upper))
    options.start = with_bounds(start.network, samples.lower, samples.upper);
  if (!model_options.start_is_foreign) {
    const auto start_split = samples_of(start, data).split;
    require(start_split.test == parts.test && start_split.validation == parts.validation,
            "the same data and shares of the split, or --start-foreign");
  }
  options.shape = start.network.shape;
  options.geometry = start.network.geometry;
}

/// The input of a training, made from the data and the options of a model.
struct PreparedTraining {
  std::shared_ptr<const tiling::Family> family;
  std::string definition;  ///< as in neural::Model
  Samples samples;
  Split parts;
  TrainingOptions training;
  std::vector<RestStiffness> rest;
};

PreparedTraining prepare(const ModelData& data, const ModelOptions& options) {
  const auto& recipe = data.data.recipe;
  const auto definition = recipe.has("definition") ? recipe.text("definition") : std::string();
  const auto shared = tiling::family_of(recipe.text("family"), definition);
  const auto& family = *shared;
  PreparedTraining prepared{shared, definition, read_samples(data, options.samples), {}, options.training, {}};
  prepared.parts = split(prepared.samples, options.split);
  auto& training = prepared.training;
  training.shape.parameters = static_cast<int>(prepared.samples.lower.size());
  if (options.start) {
    start_from(options, data, family.id, definition, prepared.samples, prepared.parts, training);
  } else if (options.use_features) {
    training.geometry = tile_geometry(family);
    training.shape.features = static_cast<int>(training.geometry.features.size());
  }
  if (options.use_symmetry) training.symmetries = energy_symmetries(family);
  prepared.rest = read_rest(data);
  return prepared;
}

/// The model of a trained network with its id, bounds and measured errors, but without its provenance.
neural::Model model_of(const PreparedTraining& prepared, const ModelOptions& options, const neural::Network& network) {
  neural::Model model;
  model.id = options.id;
  if (model.id.empty())
    std::transform(prepared.family->id.begin(), prepared.family->id.end(), std::back_inserter(model.id),
                   [](unsigned char c) { return c == '_' ? '-' : static_cast<char>(std::tolower(c)); });
  model.family = prepared.family->id;
  model.definition = prepared.definition;
  model.network = narrowed(network, prepared.samples);
  model.strain_range = strain_range(model.network, prepared.samples, prepared.parts.training);
  model.design_split = split_errors(model.network, prepared.samples, prepared.parts.test);
  model.row_split = split_errors(model.network, prepared.samples, prepared.parts.row_test);
  return model;
}

/// Fills in the provenance of a finished model except `data_set`, `engine` and `designs`.
void describe_origin(neural::Provenance& provenance, const PreparedTraining& prepared, const ModelOptions& options,
                     const ModelData& data, double seconds) {
  provenance.data_engine = engines_of(data);
  provenance.rows = static_cast<std::int64_t>(prepared.parts.training.size());
  provenance.seed = prepared.training.seed;
  auto described = options;
  described.training = prepared.training;
  provenance.options = describe(described);
  provenance.training_seconds = seconds;
  if (const auto& start = options.start) {
    provenance.training_seconds += start->provenance.training_seconds;
    int epochs = 0;  // sum over all trainings before this one
    for (const auto& [name, value] : start->provenance.options)
      if (name == "epochs" || name == "start_epochs") epochs += std::atoi(value.c_str());
    provenance.options.emplace_back("start_epochs", std::to_string(epochs));
    if (options.start_is_foreign) {
      provenance.options.emplace_back("start_model", start->id);
      provenance.options.emplace_back("start_data", start->provenance.data_set);
    }
  }
  if (!prepared.rest.empty()) provenance.options.emplace_back("rest_designs", std::to_string(prepared.rest.size()));
  provenance.youngs_modulus = data.data.recipe.number("youngs_modulus");
  provenance.poisson_ratio = data.data.recipe.number("poisson_ratio");
}

}  // namespace

std::vector<EnergySymmetry> energy_symmetries(const tiling::Family& family) {
  std::vector<EnergySymmetry> distinct;
  for (const auto& tiling_symmetry : tiling::symmetries(family)) {
    const EnergySymmetry symmetry{strain_transformation(tiling_symmetry.operation), tiling_symmetry.linear,
                                  tiling_symmetry.constant};
    if (std::none_of(distinct.begin(), distinct.end(), [&](const EnergySymmetry& other) {
          return other.strain.isApprox(symmetry.strain, 1e-9) && other.linear.isApprox(symmetry.linear, 1e-6) &&
                 (other.constant - symmetry.constant).norm() < 1e-6;
        }))
      distinct.push_back(symmetry);
  }
  // The first one is the identity.
  distinct.erase(distinct.begin());
  return distinct;
}

std::vector<std::pair<std::string, std::string>> describe(const ModelOptions& options) {
  auto all = describe(options.training);
  const auto add = [&](const char* name, const auto& value) { all.emplace_back(name, fmt::format("{}", value)); };
  add("least_energy", options.samples.min_energy);
  add("largest_energy", options.samples.max_energy);
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
  const SplitOptions split_options{number("validation_share"), number("test_share"), number("row_test_share"),
                                   static_cast<std::int64_t>(number("split_seed"))};
  ModelSamples result{read_samples(data, options), {}, options};
  result.split = split(result.samples, split_options);
  // Other data would be split in another way. The model would then be tested on designs on which it was trained.
  if (static_cast<std::int64_t>(result.split.training.size()) != model.provenance.rows)
    throw Error("training.different_data",
                fmt::format("The model {} was trained on {} states; of this data, its split trains on {}.", model.id,
                            model.provenance.rows, result.split.training.size()),
                {{"data", model.provenance.data_set}});
  return result;
}

neural::Model symmetrized(neural::Model model, const ModelData& data) {
  const auto shared = tiling::family_of(model.family, model.definition);
  const auto& family = *shared;
  const auto [samples, parts, options] = samples_of(model, data);
  auto& symmetries = model.network.symmetries;
  symmetries.clear();
  // The error bars belong to the network without the symmetries.
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
  const auto prepared = prepare(data, options);
  const auto trained = train(prepared.samples, prepared.parts, prepared.training, checkpoint, cancellation, report,
                             prepared.rest, stiffness_report);
  ModelResult result;
  result.history = trained.history;
  result.stiffness = trained.stiffness;
  result.best_epoch = trained.best_epoch;
  result.finished = trained.finished;
  if (!trained.finished) return result;
  result.model = model_of(prepared, options, trained.network);
  auto& provenance = result.model.provenance;
  provenance.data_set = data_name;
  provenance.engine = engine;
  provenance.designs = static_cast<std::int64_t>(prepared.samples.designs.size()) - result.model.design_split->designs;
  describe_origin(provenance, prepared, options, data, trained.history.empty() ? 0 : trained.history.back().seconds);
  provenance.options.emplace_back("device", to_string(trained.device));
  return result;
}

bool export_model_training(const ModelData& data, const ModelOptions& options, const std::filesystem::path& path,
                           const CancellationToken& cancellation,
                           const std::function<void(const StiffnessReport&)>& stiffness_report) {
  const auto prepared = prepare(data, options);
  return export_training(path, prepared.samples, prepared.parts, prepared.training, prepared.rest, cancellation,
                         stiffness_report);
}

ModelResult import_model_training(const ModelData& data, const std::string& data_name, const std::string& engine,
                                  const ModelOptions& options, const std::filesystem::path& path) {
  const auto prepared = prepare(data, options);
  check(prepared.training, prepared.samples);
  const auto trained = read_trained(path, prepared.samples, prepared.parts, prepared.training, prepared.rest);
  ModelResult result;
  result.finished = true;
  result.model = model_of(prepared, options, trained.network);
  auto& provenance = result.model.provenance;
  provenance.data_set = data_name;
  provenance.engine = engine;
  provenance.designs = static_cast<std::int64_t>(prepared.samples.designs.size()) - result.model.design_split->designs;
  describe_origin(provenance, prepared, options, data, trained.seconds);
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
