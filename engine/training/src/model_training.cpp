#include "supple/training/model_training.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iterator>
#include <numbers>
#include <set>

#include "supple/base/error.h"
#include "supple/training/model_errors.h"

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

/// Rotations by multiples of 30 degrees and reflections in lines as far apart: those that a plane lattice can have
/// along the axes are among them. Where a family's lattice is turned, so are its mirrors: they are found between its
/// edges.
std::vector<Eigen::Matrix2d> point_operations() {
  std::vector<Eigen::Matrix2d> operations;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(i * std::numbers::pi / 6).toRotationMatrix();
    operations.push_back(rotation);
    operations.push_back(rotation * Eigen::Vector2d(1, -1).asDiagonal());
  }
  return operations;
}

constexpr double same_place = 1e-7;

/// Whether two points differ by a translation of the lattice.
bool equal_on_torus(const Eigen::Matrix2d& inverse_lattice, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d difference = inverse_lattice * (a - b);
  return (difference - difference.array().round().matrix()).norm() < same_place;
}

/// An edge of the tiling: its middle and its vector, whose sign means nothing.
struct Edge {
  Eigen::Vector2d middle;
  Eigen::Vector2d vector;
};

std::vector<Edge> edges_of(const tiling::Tiling& tiling) {
  std::vector<Edge> edges;
  for (const auto& placement : tiling.placements) {
    const auto& tile = tiling.tiles[static_cast<std::size_t>(placement.tile)];
    for (std::size_t i = 0; i < tile.size(); ++i) {
      const Eigen::Vector2d a = placement.linear * tile[i] + placement.offset;
      const Eigen::Vector2d b = placement.linear * tile[(i + 1) % tile.size()] + placement.offset;
      edges.push_back({0.5 * (a + b), b - a});
    }
  }
  return edges;
}

/// Whether `operation`, followed by some translation, carries each edge to an edge.
bool maps_tiling_to_itself(const Eigen::Matrix2d& operation, const tiling::Tiling& tiling) {
  const Eigen::Matrix2d inverse = tiling.lattice.inverse();
  const Eigen::Matrix2d on_lattice = inverse * operation * tiling.lattice;
  if ((on_lattice - on_lattice.array().round().matrix()).norm() > same_place) return false;
  const auto edges = edges_of(tiling);
  const auto is_edge = [&](const Edge& image) {
    return std::any_of(edges.begin(), edges.end(), [&](const Edge& edge) {
      return equal_on_torus(inverse, image.middle, edge.middle) &&
             std::min((image.vector - edge.vector).norm(), (image.vector + edge.vector).norm()) < same_place;
    });
  };
  return std::any_of(edges.begin(), edges.end(), [&](const Edge& target) {
    const Eigen::Vector2d translation = target.middle - operation * edges[0].middle;
    return std::all_of(edges.begin(), edges.end(), [&](const Edge& edge) {
      return is_edge({operation * edge.middle + translation, operation * edge.vector});
    });
  });
}

/// The versions of the engine that computed the designs.
std::string engines_of(const dataset::Dataset& data) {
  std::set<std::string> engines;
  for (const auto& design : data.designs) engines.insert(design.engine);
  std::string text;
  for (const auto& engine : engines) text += (text.empty() ? "" : ", ") + engine;
  return text;
}

}  // namespace

std::vector<Eigen::Matrix3d> strain_symmetries(const tiling::Family& family) {
  // Away from the middle, where a family may have more symmetry than elsewhere.
  std::vector<double> parameters;
  for (std::size_t k = 0; k < family.parameters.size(); ++k) {
    const auto& [lower, upper, preset] = family.parameters[k];
    parameters.push_back(preset + (0.137 + 0.071 * static_cast<double>(k)) * (upper - preset));
  }
  const auto tiling = family.shape(parameters);
  std::vector<Eigen::Matrix3d> maps{Eigen::Matrix3d::Identity()};
  for (const auto& candidate : point_operations()) {
    const auto map = strain_map(candidate);
    if (std::any_of(maps.begin(), maps.end(), [&](const auto& known) { return known.isApprox(map, 1e-9); })) continue;
    if (maps_tiling_to_itself(candidate, tiling)) maps.push_back(map);
  }
  maps.erase(maps.begin());
  return maps;
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

ModelSamples samples_of(const neural::Model& model, const dataset::Dataset& data) {
  const auto number = [&](const char* name) {
    for (const auto& [option, value] : model.provenance.options)
      if (option == name) return std::strtod(value.c_str(), nullptr);
    throw Error("file.unreadable", fmt::format("The model {} does not say its {}.", model.id, name));
  };
  const SampleOptions options{number("least_energy"), number("largest_energy")};
  const SplitOptions shares{number("validation_share"), number("test_share"), number("row_test_share"),
                            static_cast<std::int64_t>(number("split_seed"))};
  ModelSamples made{read_samples(data, options), {}};
  made.split = split(made.samples, shares);
  // Other designs would be split in another way: some that the model was trained on would then judge it.
  if (static_cast<std::int64_t>(made.split.training.size()) != model.provenance.rows)
    throw Error("training.different_data",
                fmt::format("The model {} was trained on {} states; of this data, its split trains on {}.", model.id,
                            model.provenance.rows, made.split.training.size()),
                {{"data", model.provenance.data_set}});
  return made;
}

ModelResult train_model(const dataset::Dataset& data, const std::string& data_name, const std::string& engine,
                        const ModelOptions& options, const std::filesystem::path& checkpoint,
                        const CancellationToken& cancellation, const std::function<void(const EpochReport&)>& report) {
  const auto& family = tiling::family(data.recipe.text("family"));
  const auto samples = read_samples(data, options.samples);
  const auto parts = split(samples, options.split);
  auto training_options = options.training;
  training_options.shape.parameters = static_cast<int>(samples.lower.size());
  if (options.use_symmetry) training_options.symmetries = strain_symmetries(family);
  const auto trained = train(samples, parts, training_options, checkpoint, cancellation, report);

  ModelResult result;
  result.history = trained.history;
  result.best_epoch = trained.best_epoch;
  result.finished = trained.finished;
  auto& model = result.model;
  model.id = options.id;
  if (model.id.empty())
    std::transform(family.id.begin(), family.id.end(), std::back_inserter(model.id),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  model.family = family.id;
  model.network = trained.network;
  if (!trained.finished) return result;
  model.strain_range = strain_range(model.network, samples, parts.training);
  model.design_split = split_errors(model.network, samples, parts.test);
  model.row_split = split_errors(model.network, samples, parts.row_test);
  auto& provenance = model.provenance;
  provenance.data_set = data_name;
  provenance.data_engine = engines_of(data);
  provenance.engine = engine;
  provenance.designs = static_cast<std::int64_t>(samples.designs.size()) - model.design_split->designs;
  provenance.rows = static_cast<std::int64_t>(parts.training.size());
  provenance.seed = training_options.seed;
  auto described = options;
  described.training = training_options;
  provenance.options = describe(described);
  provenance.training_seconds = trained.history.empty() ? 0 : trained.history.back().seconds;
  provenance.youngs_modulus = data.recipe.number("youngs_modulus");
  provenance.poisson_ratio = data.recipe.number("poisson_ratio");
  return result;
}

}  // namespace supple::training
