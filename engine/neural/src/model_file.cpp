#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibration_file.h"
#include "supple/base/error.h"
#include "supple/base/helper_processes.h"
#include "supple/files/durable_file.h"
#include "supple/files/hdf5_file.h"
#include "supple/files/seal.h"
#include "supple/neural/helper_tasks.h"
#include "supple/neural/model.h"

namespace supple::neural {
namespace {

constexpr std::string_view read_task = "neural/model";

/// A model takes less than a second, so that a file which takes longer than this is none.
constexpr std::chrono::seconds max_read_cpu_time{60};

using files::Hdf5Reader;
using files::Hdf5Writer;

constexpr const char* layout_name = "supple model";
/// Version 2 of the layout adds the form of rest, the number of layers of the stiffness branch, and the features of the
/// tile. Version 3 adds the correction of the mesh, and version 4 beams whose width depends on the parameters. A
/// network is written in the lowest version that has all it needs, so that older programs can read it.
constexpr std::int64_t newest_version = 4;

std::int64_t version_of(const Network& network) {
  if (!network.geometry.beam_width_slopes.empty()) return 4;
  if (network.mesh_correction.size() > 0) return 3;
  const NetworkShape& shape = network.shape;
  const NetworkShape plain;
  return shape.rest == plain.rest && shape.stiffness_layers == plain.stiffness_layers && shape.features == 0 ? 1 : 2;
}

struct Branch {
  const char* name;
  std::vector<Layer> Network::*layers;
};
constexpr std::array<Branch, 4> branches{{{"strain", &Network::strain},
                                          {"parameter", &Network::parameter},
                                          {"trunk", &Network::trunk},
                                          {"stiffness", &Network::stiffness}}};

/// Calls visit(name, size) for the sizes of a network's layers.
template <class Shape, class Visit>
void for_each_size(Shape& shape, Visit&& visit) {
  visit("parameters", shape.parameters);
  visit("width", shape.width);
  visit("strain_layers", shape.strain_layers);
  visit("parameter_layers", shape.parameter_layers);
  visit("trunk_layers", shape.trunk_layers);
  visit("residuals", shape.residuals);
  visit("stiffness_width", shape.stiffness_width);
}
template <class Statistics, class Visit>
void for_each_statistic(Statistics& statistics, Visit&& visit) {
  visit("mean", statistics.mean);
  visit("root_mean_square", statistics.root_mean_square);
  visit("median", statistics.median);
  visit("percentile_99", statistics.percentile_99);
}
template <class Range, class Visit>
void for_each_limit(Range& range, Visit&& visit) {
  visit("smallest_principal", range.smallest_principal);
  visit("largest_principal", range.largest_principal);
  visit("largest_energy", range.largest_relative_energy);
}
template <class P, class Visit>
void for_each_fact(P& provenance, Visit&& visit) {
  visit("data_set", provenance.data_set);
  visit("data_engine", provenance.data_engine);
  visit("engine", provenance.engine);
  visit("designs", provenance.designs);
  visit("rows", provenance.rows);
  visit("seed", provenance.seed);
  visit("training_seconds", provenance.training_seconds);
  visit("youngs_modulus", provenance.youngs_modulus);
  visit("poisson_ratio", provenance.poisson_ratio);
}

std::vector<double> numbers(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  std::vector<double> rows;
  rows.reserve(static_cast<std::size_t>(matrix.size()));
  for (long i = 0; i < matrix.rows(); ++i)
    for (long j = 0; j < matrix.cols(); ++j) rows.push_back(matrix(i, j));
  return rows;
}

std::string layer_name(const Branch& branch, std::size_t layer) {
  return std::string("network/") + branch.name + "/" + std::to_string(layer);
}

/// Writes what version 2 adds.
void write_extension(Hdf5Writer& file, const NetworkShape& shape, const TileGeometry& geometry) {
  file.value("network/rest", std::string(to_string(shape.rest)));
  file.value("network/stiffness_layers", std::int64_t{shape.stiffness_layers});
  file.value("network/features", std::int64_t{shape.features});
  if (shape.features == 0) return;
  const std::string group = "network/geometry";
  file.group(group);
  const int columns = 1 + shape.parameters;
  const auto points = [&](const std::string& name, const auto& list) {
    std::vector<double> values;
    for (const Eigen::Matrix2Xd& point : list) {
      const auto rows = numbers(point);
      values.insert(values.end(), rows.begin(), rows.end());
    }
    file.column(group + "/" + name, values, 2 * columns);
  };
  points("vertices", geometry.vertices);
  points("translations", geometry.translations);
  file.value(group + "/tiles", std::int64_t{geometry.tiles});
  file.value(group + "/beam_width", geometry.beam_width);
  if (!geometry.beam_width_slopes.empty()) file.column(group + "/beam_width_slopes", geometry.beam_width_slopes, 0);
  std::vector<std::string> kinds;
  std::vector<std::int64_t> places;
  std::vector<double> normalization;
  for (const auto& feature : geometry.features) {
    kinds.emplace_back(to_string(feature.kind));
    places.insert(places.end(), {feature.edge, feature.vertex});
    normalization.insert(normalization.end(), {feature.mean, feature.scale});
  }
  file.column(group + "/feature_kind", kinds);
  file.column(group + "/feature_edge_and_vertex", places, 2);
  file.column(group + "/feature_mean_and_scale", normalization, 2);
}

void read_extension(const Hdf5Reader& file, NetworkShape& shape, TileGeometry& geometry) {
  const auto size = [&](const std::string& name) {
    return static_cast<int>(std::clamp<std::int64_t>(file.integer(name), -1, 1 << 20));
  };
  shape.rest = rest_form_of(file.text("network/rest"));
  shape.stiffness_layers = size("network/stiffness_layers");
  shape.features = size("network/features");
  if (shape.features == 0) return;
  const std::string group = "network/geometry";
  const auto points = [&](const std::string& name) {
    const int components = file.components(group + "/" + name);
    const auto values = file.column<double>(group + "/" + name, components);
    std::vector<Eigen::Matrix2Xd> list;
    using RowMajor = Eigen::Matrix<double, 2, -1, Eigen::RowMajor>;
    for (std::size_t i = 0; components > 0 && i + static_cast<std::size_t>(components) <= values.size();
         i += static_cast<std::size_t>(components))
      list.emplace_back(Eigen::Map<const RowMajor>(values.data() + i, 2, components / 2));
    return list;
  };
  geometry.vertices = points("vertices");
  const auto translations = points("translations");
  if (translations.size() != geometry.translations.size())
    throw Error("model.invalid_network", "geometry: a lattice has two translations.");
  std::copy(translations.begin(), translations.end(), geometry.translations.begin());
  geometry.tiles = size(group + "/tiles");
  geometry.beam_width = file.real(group + "/beam_width");
  if (file.contains(group + "/beam_width_slopes"))
    geometry.beam_width_slopes = file.column<double>(group + "/beam_width_slopes", 0);
  const auto kinds = file.text_column(group + "/feature_kind");
  const auto rows = static_cast<std::int64_t>(kinds.size());
  const auto places = file.column<std::int64_t>(group + "/feature_edge_and_vertex", 2, rows);
  const auto normalization = file.column<double>(group + "/feature_mean_and_scale", 2, rows);
  const auto place = [&](std::size_t i) { return static_cast<int>(std::clamp<std::int64_t>(places[i], -1, 1 << 20)); };
  for (std::size_t i = 0; i < kinds.size(); ++i)
    geometry.features.push_back(
        {feature_kind_of(kinds[i]), place(2 * i), place(2 * i + 1), normalization[2 * i], normalization[2 * i + 1]});
}

void write_network(Hdf5Writer& file, const Network& network) {
  file.group("network");
  for_each_size(network.shape,
                [&](const char* name, int value) { file.value(std::string("network/") + name, std::int64_t{value}); });
  file.value("network/activation", std::string(to_string(network.shape.activation)));
  file.value("network/form", std::string(to_string(network.shape.form)));
  file.column("network/lower", numbers(network.lower), 0);
  file.column("network/upper", numbers(network.upper), 0);
  if (!network.symmetries.empty()) {
    std::vector<double> maps;
    for (const auto& map : network.symmetries) {
      const auto rows = numbers(map);
      maps.insert(maps.end(), rows.begin(), rows.end());
    }
    file.column("network/symmetries", maps, 9);
  }
  if (version_of(network) > 1) write_extension(file, network.shape, network.geometry);
  if (network.mesh_correction.size() > 0)
    file.column("network/mesh_correction", numbers(network.mesh_correction),
                static_cast<int>(network.mesh_correction.cols()));
  for (const auto& branch : branches) {
    file.group(std::string("network/") + branch.name);
    const auto& layers = network.*branch.layers;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const auto name = layer_name(branch, i);
      file.group(name);
      file.column(name + "/weights", numbers(layers[i].weights), static_cast<int>(layers[i].weights.cols()));
      file.column(name + "/bias", numbers(layers[i].bias), 0);
    }
  }
}

Network read_network(const Hdf5Reader& file, std::int64_t version) {
  Network network;
  for_each_size(network.shape, [&](const char* name, int& value) {
    const auto stored = file.integer(std::string("network/") + name);
    value = static_cast<int>(std::clamp<std::int64_t>(stored, -1, 1 << 20));
  });
  network.shape.activation = activation_of(file.text("network/activation"));
  network.shape.form = energy_form_of(file.text("network/form"));
  if (version > 1) read_extension(file, network.shape, network.geometry);
  const auto vector_of = [&](const std::string& name) {
    const auto values = file.column<double>(name, 0);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<long>(values.size())));
  };
  network.lower = vector_of("network/lower");
  network.upper = vector_of("network/upper");
  using RowMajor = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;
  const auto matrix_of = [&](const std::string& name) {
    const int columns = file.components(name);
    const auto values = file.column<double>(name, columns);
    return Eigen::MatrixXd(
        Eigen::Map<const RowMajor>(values.data(), static_cast<long>(values.size()) / std::max(columns, 1), columns));
  };
  // Newer layouts than that of the correction may be without it.
  if (version == 3 || file.contains("network/mesh_correction"))
    network.mesh_correction = matrix_of("network/mesh_correction");
  for (const auto& branch : branches) {
    auto& layers = network.*branch.layers;
    const auto members = file.members(std::string("network/") + branch.name);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const auto name = layer_name(branch, i);
      layers.push_back({matrix_of(name + "/weights"), vector_of(name + "/bias")});
    }
  }
  // The column is missing if the network has no symmetries.
  const auto parts = file.members("network");
  if (std::find(parts.begin(), parts.end(), "symmetries") != parts.end()) {
    const auto maps = file.column<double>("network/symmetries", 9);
    for (std::size_t i = 0; i + 9 <= maps.size(); i += 9)
      network.symmetries.emplace_back(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(maps.data() + i));
  }
  validate(network);
  return network;
}

void write_errors(Hdf5Writer& file, const std::string& split, const std::optional<SplitErrors>& errors) {
  if (!errors) return;
  const std::string group = "errors/" + split;
  file.group(group);
  file.value(group + "/designs", errors->designs);
  file.value(group + "/samples", errors->samples);
  const auto statistics = [&](const std::string& of, const ErrorStatistics& values) {
    file.group(group + "/" + of);
    for_each_statistic(values,
                       [&](const char* name, double value) { file.value(group + "/" + of + "/" + name, value); });
  };
  statistics("energy", errors->energy);
  statistics("gradient", errors->gradient);
}

std::optional<SplitErrors> read_errors(const Hdf5Reader& file, const std::string& split) {
  const auto splits = file.members("errors");
  if (std::find(splits.begin(), splits.end(), split) == splits.end()) return std::nullopt;
  const std::string group = "errors/" + split;
  SplitErrors errors;
  errors.designs = file.integer(group + "/designs");
  errors.samples = file.integer(group + "/samples");
  const auto statistics = [&](const std::string& of, ErrorStatistics& values) {
    for_each_statistic(values,
                       [&](const char* name, double& value) { value = file.real(group + "/" + of + "/" + name); });
  };
  statistics("energy", errors.energy);
  statistics("gradient", errors.gradient);
  return errors;
}

struct ReadFact {
  const Hdf5Reader& file;
  void operator()(const char* name, std::string& value) const { value = file.text(path(name)); }
  void operator()(const char* name, std::int64_t& value) const { value = file.integer(path(name)); }
  void operator()(const char* name, double& value) const { value = file.real(path(name)); }
  static std::string path(const char* name) { return std::string("provenance/") + name; }
};

/// Throws unless a name is short and has only allowed characters, which are those of the service's contract. Ids and
/// families are parts of addresses and of file names.
void check_name(const char* field, const std::string& name, std::size_t max_length, std::string_view characters) {
  if (!name.empty() && name.size() <= max_length && name.find_first_not_of(characters) == std::string::npos) return;
  const auto rule = "1 to " + std::to_string(max_length) + " of " + std::string(characters);
  throw Error("model.invalid_id", std::string("A model's ") + field + " is made of " + rule + ", got \"" + name + "\".",
              {{field, rule}});
}

void check_names(const Model& model) {
  check_name("id", model.id, 64, "abcdefghijklmnopqrstuvwxyz0123456789-");
  check_name("family", model.family, 32, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-");
}

void write_content(Hdf5Writer& file, const Model& model) {
  file.attribute("/", "layout", layout_name);
  file.attribute("/", "version", version_of(model.network));
  file.value("id", model.id);
  file.value("family", model.family);
  if (!model.definition.empty()) file.value("definition", model.definition);
  write_network(file, model.network);
  file.group("strain_range");
  for_each_limit(model.strain_range,
                 [&](const char* name, double value) { file.value(std::string("strain_range/") + name, value); });
  file.group("errors");
  write_errors(file, "design_split", model.design_split);
  write_errors(file, "row_split", model.row_split);
  write_calibration(file, model.calibration);
  file.group("provenance");
  for_each_fact(model.provenance,
                [&](const char* name, const auto& value) { file.value(std::string("provenance/") + name, value); });
  file.group("provenance/options");
  for (const auto& [name, value] : model.provenance.options) file.value("provenance/options/" + name, value);
}

Model read_content(const Hdf5Reader& file, const std::string& name) {
  if (file.text_attribute("/", "layout") != layout_name) throw Error("file.unreadable", name + ": it is no model.");
  const auto version = file.integer_attribute("/", "version");
  if (version < 1 || version > newest_version)
    throw Error("file.unreadable", name + ": its layout has version " + std::to_string(version) +
                                       "; this program reads versions 1 to " + std::to_string(newest_version) + ".");
  Model model;
  model.id = file.text("id");
  model.family = file.text("family");
  if (file.contains("definition")) model.definition = file.text("definition");
  check_names(model);
  model.network = read_network(file, version);
  for_each_limit(model.strain_range,
                 [&](const char* limit, double& value) { value = file.real(std::string("strain_range/") + limit); });
  model.design_split = read_errors(file, "design_split");
  model.row_split = read_errors(file, "row_split");
  model.calibration = read_calibration(file, model.network.shape.parameters);
  for_each_fact(model.provenance, ReadFact{file});
  for (const auto& option : file.members("provenance/options"))
    model.provenance.options.emplace_back(option, file.text("provenance/options/" + option));
  return model;
}

}  // namespace

void write_model(const std::filesystem::path& path, const Model& model) {
  check_names(model);
  validate(model.network);
  auto unfinished = path;
  unfinished += ".writing";
  {
    Hdf5Writer file(unfinished);
    write_content(file, model);
    file.close();
  }
  files::seal(unfinished);
  files::move_into_place(unfinished, path);
}

Model read_model(const std::filesystem::path& path) {
  files::check_seal(path);
  return read_content(Hdf5Reader(path), path.string());
}

Model read_model(std::string_view bytes, const std::string& name, const Execution& execution) {
  files::check_seal(bytes, name);
  const auto helpers = helper_processes();
  if (!helpers) return read_content(Hdf5Reader(bytes, name), name);
  const std::string written = [&] {
    try {
      return helpers->run(read_task, bytes, execution);
    } catch (const HelperEnded&) {
      throw Error("file.unreadable", name + ": it is damaged: the process that reads it ends, or takes more than " +
                                         std::to_string(max_read_cpu_time.count()) + " s of CPU time.");
    }
  }();
  return read_content(Hdf5Reader(written, name), name);
}

HelperTasks helper_tasks() {
  return {{std::string(read_task), [](std::string_view bytes) {
             // Each task has a process of its own.
             limit_cpu_time(max_read_cpu_time);
             // The bytes are written anew, so that they contain nothing from the file but the model.
             Hdf5Writer file;
             write_content(file, read_content(Hdf5Reader(bytes, "the file"), "the file"));
             return file.bytes();
           }}};
}

}  // namespace supple::neural
