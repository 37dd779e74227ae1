#include "supple/training/samples.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <string_view>
#include <utility>

#include "supple/base/error.h"
#include "supple/base/random.h"

namespace supple::training {
namespace {

bool is_usable(const dataset::Row& row, const SampleOptions& options) {
  return row.stable && row.energy_density >= options.min_energy && row.energy_density <= options.max_energy &&
         std::all_of(row.tangent.begin(), row.tangent.end(), [](double c) { return std::isfinite(c); });
}

/// 0, ..., n - 1 in random order.
std::vector<int> shuffled(int n, const char* name, std::int64_t seed) {
  RandomStream stream(name, static_cast<std::uint64_t>(seed));
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  for (int i = n - 1; i > 0; --i)
    std::swap(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(stream.below(i + 1))]);
  return order;
}

/// Settings that select designs and loads, and the family's bounds when the data were made. Data sets that differ in
/// these settings alone are simulated in the same way.
constexpr std::array<std::string_view, 22> design_settings{"seed",
                                                           "lower_bounds",
                                                           "upper_bounds",
                                                           "box_margin",
                                                           "corners",
                                                           "parameters",
                                                           "list",
                                                           "directions",
                                                           "part_lower",
                                                           "part_upper",
                                                           "plan",
                                                           "tension_paths",
                                                           "compression_paths",
                                                           "biaxial_paths",
                                                           "tension_states",
                                                           "compression_states",
                                                           "biaxial_states",
                                                           "largest_stretch",
                                                           "smallest_stretch",
                                                           "largest_biaxial_stretch",
                                                           "smallest_biaxial_stretch",
                                                           "first_strain"};

dataset::Recipe without_design_settings(const dataset::Recipe& recipe) {
  dataset::Recipe result;
  for (const auto& setting : recipe.settings())
    if (std::find(design_settings.begin(), design_settings.end(), setting.name) == design_settings.end())
      result.set(setting.name, setting.value, setting.unit);
  return result;
}

void check_training_only_data(const ModelData& data) {
  const auto data_recipe = without_design_settings(data.data.recipe);
  for (std::size_t i = 0; i < data.more.size(); ++i) {
    const auto differing = dataset::differences(data_recipe, without_design_settings(data.more[i].recipe));
    if (differing.empty()) continue;
    std::vector<Error::Detail> details;
    details.reserve(differing.size());
    for (const auto& difference : differing) details.push_back({"more[" + std::to_string(i) + "]", difference});
    throw Error("dataset.different_recipe",
                "Further data " + std::to_string(i) + " were simulated in another way: " + differing.front() + ".",
                details);
  }
}

/// Settings on which the stiffness of an undeformed design depends.
constexpr std::array<std::string_view, 10> rest_stiffness_settings{
    "family",    "definition",  "law",         "youngs_modulus", "poisson_ratio",
    "mesh_size", "corner_size", "mesh_region", "refinement",     "beam_width"};

/// Those settings that determine the mesh.
constexpr std::array<std::string_view, 4> mesh_settings{"mesh_size", "corner_size", "mesh_region", "refinement"};

dataset::Recipe rest_stiffness_recipe(const dataset::Recipe& recipe, bool with_mesh = true) {
  const auto is_among = [](const auto& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  dataset::Recipe result;
  for (const auto& setting : recipe.settings())
    if (is_among(rest_stiffness_settings, setting.name) && (with_mesh || !is_among(mesh_settings, setting.name)))
      result.set(setting.name, setting.value, setting.unit);
  return result;
}

void check_rest(const ModelData& data) {
  for (std::size_t i = 0; i < data.rest.size(); ++i) {
    const auto differing =
        dataset::differences(rest_stiffness_recipe(data.data.recipe), rest_stiffness_recipe(data.rest[i].recipe));
    if (differing.empty()) continue;
    std::vector<Error::Detail> details;
    details.reserve(differing.size());
    for (const auto& difference : differing) details.push_back({"rest[" + std::to_string(i) + "]", difference});
    throw Error("dataset.different_recipe",
                "Rest stiffnesses " + std::to_string(i) + " were simulated in another way: " + differing.front() + ".",
                details);
  }
}

bool within_bounds(const std::vector<double>& parameters, const Samples& samples) {
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (!(parameters[k] >= samples.lower[k] && parameters[k] <= samples.upper[k])) return false;
  return true;
}

}  // namespace

Samples read_samples(const ModelData& data, const SampleOptions& options) {
  check_training_only_data(data);
  Samples samples;
  samples.lower = data.data.recipe.numbers("lower_bounds");
  samples.upper = data.data.recipe.numbers("upper_bounds");
  std::vector<const dataset::Row*> rows;
  int design_index = 0;
  const auto add = [&](const dataset::Dataset& set, bool is_training_only) {
    for (const auto& design : set.designs) {
      SampledDesign sampled{design.index, design.parameters, static_cast<int>(rows.size()), 0,
                            is_training_only || !within_bounds(design.parameters, samples)};
      for (std::size_t i = 0; i < design.rows.size(); ++i) {
        if (!is_usable(design.rows[i], options)) continue;
        rows.push_back(&design.rows[i]);
        samples.source.push_back({design_index, static_cast<int>(i)});
      }
      sampled.count = static_cast<int>(rows.size()) - sampled.first;
      if (sampled.count > 0) samples.designs.push_back(std::move(sampled));
      ++design_index;
    }
  };
  add(data.data, false);
  for (const auto& set : data.more) add(set, true);
  if (rows.empty())
    throw Error("training.no_samples", "The data set holds no stable state that a network could learn from.");
  const auto n = static_cast<long>(rows.size());
  samples.strain.resize(3, n);
  samples.stress.resize(3, n);
  samples.energy.resize(n);
  samples.tangent.resize(6, n);
  for (long i = 0; i < n; ++i) {
    const auto& row = *rows[static_cast<std::size_t>(i)];
    samples.strain.col(i) << row.green_strain[0], row.green_strain[1], 2 * row.green_strain[2];
    samples.stress.col(i) = Eigen::Map<const Eigen::Vector3d>(row.stress.data());
    samples.energy[i] = row.energy_density;
    samples.tangent.col(i) = Eigen::Map<const Eigen::Matrix<double, 6, 1>>(row.tangent.data());
  }
  return samples;
}

void check_same_solid(const ModelData& data, const dataset::Dataset& other) {
  const auto differing =
      dataset::differences(rest_stiffness_recipe(data.data.recipe, false), rest_stiffness_recipe(other.recipe, false));
  if (!differing.empty())
    throw Error("dataset.different_recipe", "The reference is of another structure: " + differing.front() + ".",
                {{"reference", differing.front()}});
}

std::vector<RestStiffness> rest_stiffnesses(const dataset::Dataset& data) {
  std::vector<RestStiffness> rest;
  for (const auto& design : data.designs) {
    const dataset::Row* smallest_strain_row = nullptr;
    const auto strain_norm = [](const dataset::Row& row) {
      return Eigen::Map<const Eigen::Vector3d>(row.green_strain.data()).norm();
    };
    for (const auto& row : design.rows) {
      const bool finite =
          std::all_of(row.tangent.begin(), row.tangent.end(), [](double c) { return std::isfinite(c); });
      if (finite && (!smallest_strain_row || strain_norm(row) < strain_norm(*smallest_strain_row)))
        smallest_strain_row = &row;
    }
    if (!smallest_strain_row) continue;
    const auto& c = smallest_strain_row->tangent;
    Eigen::Matrix3d tangent;
    tangent << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
    if (Eigen::LLT<Eigen::Matrix3d>(tangent).info() == Eigen::Success) rest.push_back({design.parameters, tangent});
  }
  return rest;
}

std::vector<RestStiffness> read_rest(const ModelData& data) {
  check_rest(data);
  std::vector<RestStiffness> rest;
  for (const auto& set : data.rest) {
    auto designs = rest_stiffnesses(set);
    std::move(designs.begin(), designs.end(), std::back_inserter(rest));
  }
  return rest;
}

Split split(const Samples& samples, const SplitOptions& options) {
  Split parts;
  const auto add = [](std::vector<int>& rows, const SampledDesign& design) {
    for (int i = 0; i < design.count; ++i) rows.push_back(design.first + i);
  };
  std::vector<const SampledDesign*> candidates;
  for (const auto& design : samples.designs) {
    if (design.trains_only)
      add(parts.training, design);
    else
      candidates.push_back(&design);
  }
  const auto n = static_cast<int>(candidates.size());
  const int test_count = static_cast<int>(std::ceil(options.test * n));
  const int held_out_count = test_count + static_cast<int>(std::ceil(options.validation * n));
  const auto order = shuffled(n, "split of designs", options.seed);
  RandomStream rows("split of rows", static_cast<std::uint64_t>(options.seed));
  for (int i = 0; i < n; ++i) {
    const auto& design = *candidates[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])];
    if (i < test_count)
      add(parts.test, design);
    else if (i < held_out_count)
      add(parts.validation, design);
    else
      for (int j = 0; j < design.count; ++j)
        (rows.uniform() < options.row_test ? parts.row_test : parts.training).push_back(design.first + j);
  }
  for (auto* part : {&parts.training, &parts.validation, &parts.test, &parts.row_test})
    std::sort(part->begin(), part->end());
  return parts;
}

}  // namespace supple::training
