#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/error.h"
#include "supple/files/durable_file.h"
#include "supple/files/hdf5_file.h"
#include "supple/files/seal.h"
#include "supple/neural/model.h"

namespace supple::neural {
namespace {

using files::Hdf5Reader;
using files::Hdf5Writer;

constexpr const char* layout_name = "supple model";
constexpr std::int64_t layout_version = 1;

struct Branch {
  const char* name;
  std::vector<Layer> Network::*layers;
};
constexpr std::array<Branch, 4> branches{{{"strain", &Network::strain},
                                          {"parameter", &Network::parameter},
                                          {"trunk", &Network::trunk},
                                          {"stiffness", &Network::stiffness}}};

/// The sizes that decide the layers, by name.
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

Network read_network(const Hdf5Reader& file) {
  Network network;
  for_each_size(network.shape, [&](const char* name, int& value) {
    const auto stored = file.integer(std::string("network/") + name);
    value = static_cast<int>(std::clamp<std::int64_t>(stored, -1, 1 << 20));
  });
  network.shape.activation = activation_of(file.text("network/activation"));
  network.shape.form = energy_form_of(file.text("network/form"));
  const auto vector_of = [&](const std::string& name) {
    const auto values = file.column<double>(name, 0);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<long>(values.size())));
  };
  network.lower = vector_of("network/lower");
  network.upper = vector_of("network/upper");
  for (const auto& branch : branches) {
    auto& layers = network.*branch.layers;
    const auto members = file.members(std::string("network/") + branch.name);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const auto name = layer_name(branch, i);
      const int columns = file.components(name + "/weights");
      const auto weights = file.column<double>(name + "/weights", columns);
      using RowMajor = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;
      layers.push_back(
          {Eigen::Map<const RowMajor>(weights.data(), static_cast<long>(weights.size()) / columns, columns),
           vector_of(name + "/bias")});
    }
  }
  // Files of networks without have no such column.
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

/// Ids and families are parts of addresses and of file names; the contract of the service allows the same.
void check_name(const char* field, const std::string& name, std::size_t longest, std::string_view characters) {
  if (!name.empty() && name.size() <= longest && name.find_first_not_of(characters) == std::string::npos) return;
  const auto rule = "1 to " + std::to_string(longest) + " of " + std::string(characters);
  throw Error("model.invalid_id", std::string("A model's ") + field + " is made of " + rule + ", got \"" + name + "\".",
              {{field, rule}});
}

void check_names(const Model& model) {
  check_name("id", model.id, 64, "abcdefghijklmnopqrstuvwxyz0123456789-");
  check_name("family", model.family, 32, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-");
}

}  // namespace

void write_model(const std::filesystem::path& path, const Model& model) {
  check_names(model);
  validate(model.network);
  auto unfinished = path;
  unfinished += ".writing";
  {
    Hdf5Writer file(unfinished);
    file.attribute("/", "layout", layout_name);
    file.attribute("/", "version", layout_version);
    file.value("id", model.id);
    file.value("family", model.family);
    write_network(file, model.network);
    file.group("strain_range");
    for_each_limit(model.strain_range,
                   [&](const char* name, double value) { file.value(std::string("strain_range/") + name, value); });
    file.group("errors");
    write_errors(file, "design_split", model.design_split);
    write_errors(file, "row_split", model.row_split);
    file.group("provenance");
    for_each_fact(model.provenance,
                  [&](const char* name, const auto& value) { file.value(std::string("provenance/") + name, value); });
    file.group("provenance/options");
    for (const auto& [name, value] : model.provenance.options) file.value("provenance/options/" + name, value);
    file.close();
  }
  files::seal(unfinished);
  files::move_into_place(unfinished, path);
}

Model read_model(const std::filesystem::path& path) {
  files::check_seal(path);
  const Hdf5Reader file(path);
  if (file.text_attribute("/", "layout") != layout_name)
    throw Error("file.unreadable", path.string() + ": it is no model.");
  if (const auto version = file.integer_attribute("/", "version"); version != layout_version)
    throw Error("file.unreadable", path.string() + ": its layout has version " + std::to_string(version) +
                                       "; this program reads version " + std::to_string(layout_version) + ".");
  Model model;
  model.id = file.text("id");
  model.family = file.text("family");
  check_names(model);
  model.network = read_network(file);
  for_each_limit(model.strain_range,
                 [&](const char* name, double& value) { value = file.real(std::string("strain_range/") + name); });
  model.design_split = read_errors(file, "design_split");
  model.row_split = read_errors(file, "row_split");
  for_each_fact(model.provenance, ReadFact{file});
  for (const auto& name : file.members("provenance/options"))
    model.provenance.options.emplace_back(name, file.text("provenance/options/" + name));
  return model;
}

}  // namespace supple::neural
