#include "supple/design/family_atlas.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "supple/base/best_so_far.h"
#include "supple/base/error.h"
#include "supple/base/number_text.h"
#include "supple/base/parallel_tasks.h"
#include "supple/base/sobol.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/mesh.h"
#include "supple/tiling/tiling_error.h"

namespace supple::design {
namespace {

/// A stiffness whose least eigenvalue is below this fraction of the largest one belongs to a mechanism.
constexpr double min_stiffness_ratio = 1e-9;

std::vector<double> sample_parameters(const tiling::Family& family, int index) {
  if (index == 0) return tiling::presets(family);
  static const SobolSequence sequence("design.family_atlas", 1);
  const auto point = sequence.point(static_cast<std::uint32_t>(index - 1));
  std::vector<double> parameters;
  for (std::size_t k = 0; k < family.parameters.size(); ++k) {
    const tiling::Parameter& range = family.parameters[k];
    parameters.push_back(range.lower + point[k] * (range.upper - range.lower));
  }
  return parameters;
}

/// The stiffness at rest of one cell, d stress / d (E_xx, E_yy, 2 E_xy) in MPa; none for a mechanism.
std::optional<Eigen::Matrix3d> rest_stiffness(const tiling::Structure& structure, double mesh_size,
                                              const AtlasOptions& options, const Execution& execution) {
  microscale::SimulationOptions simulation;
  simulation.material = options.material;
  simulation.contact = simulation.patch = simulation.buckling = Switch::off;
  simulation.mesh.mesh_size = mesh_size;
  simulation.mesh.max_nodes = options.max_nodes;
  const auto mesh = [&] {
    const StageTimer timer(execution.cost, "meshing");
    return tiling::mesh_structure(structure, simulation.mesh, execution);
  }();
  const StageTimer timer(execution.cost, "stiffness");
  microscale::GreenStrainLoad rest;
  rest.strains.emplace_back(Eigen::Vector3d::Zero());
  // The simulator's own stages would be counted twice.
  const Execution unbilled{.cancellation = execution.cancellation};
  const auto result = microscale::Simulator(mesh, simulation, unbilled).run(rest, unbilled);
  const Eigen::Matrix3d& stiffness = result.states.at(0).tangent;
  if (!stiffness.allFinite()) return std::nullopt;
  const Eigen::Vector3d values =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(stiffness, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(values[0] > min_stiffness_ratio * values[2])) return std::nullopt;
  return stiffness;
}

/// The compliance to seven digits of its largest component, a hundred times as many as its mesh gives: files of them
/// are half as large.
Compliance rounded(const Compliance& compliance) {
  const double unit = std::pow(10, std::floor(std::log10(compliance.cwiseAbs().maxCoeff())) - 6);
  // Dividing by a power of ten gives the double that is nearest to the decimal number.
  return unit < 1 ? Compliance((compliance / unit).array().round() / std::round(1 / unit))
                  : Compliance((compliance / unit).array().round() * unit);
}

/// Solves the sample, and a second time if its error is asked for. A mesh that cannot be made leaves it unsolved.
void solve(const tiling::Structure& structure, bool with_error, const AtlasOptions& options, AtlasSample& sample,
           const Execution& execution) {
  try {
    const auto stiffness = rest_stiffness(structure, options.mesh_size, options, execution);
    if (!stiffness) return;
    sample.compliance = rounded(stiffness->inverse());
    if (!with_error) return;
    if (const auto finer = rest_stiffness(structure, options.mesh_size / 2, options, execution))
      sample.error = (*stiffness - *finer).norm() / finer->norm();
  } catch (const Error&) {
    // No mesh of this size can be made, it would have more nodes than the limit, or gmsh ended on it.
  }
}

AtlasSample take_sample(const tiling::Family& family, int index, const AtlasOptions& options,
                        const Execution& execution) {
  AtlasSample sample;
  sample.parameters = sample_parameters(family, index);
  std::optional<tiling::DefinitionFlaw> flaw;
  if (family.definition) flaw = tiling::flaw_at(*family.definition, sample.parameters);
  if (flaw == tiling::DefinitionFlaw::crossing) sample.place = AtlasPlace::crossing;
  if (flaw == tiling::DefinitionFlaw::sliver) sample.place = AtlasPlace::sliver;
  if (sample.place == AtlasPlace::crossing && !options.crossings) return sample;
  std::optional<tiling::Structure> structure;
  try {
    structure = tiling::make_structure(family, sample.parameters);
  } catch (const tiling::TilingError&) {
    sample.place = AtlasPlace::closed;
    return sample;
  }
  sample.relative_density = structure->solid_area / structure->cell_area;
  solve(*structure, index < options.error_samples, options, sample, execution);
  if (!sample.compliance) sample.place = AtlasPlace::unsolved;
  return sample;
}

void check_options(const AtlasOptions& options) {
  const auto refuse = [](const std::string& field, const std::string& range) {
    throw Error("atlas.invalid_option", "The option is out of its range.", {{field, "must be " + range}});
  };
  if (options.samples < 1 || options.samples > max_atlas_samples)
    refuse("samples", "from 1 to " + std::to_string(max_atlas_samples));
  if (!(options.mesh_size > 0)) refuse("mesh_size", "above 0");
  if (options.error_samples < 0 || options.error_samples > options.samples)
    refuse("error_samples", "from 0 to the number of samples");
}

/// The same definition in a small box around its default parameters.
tiling::FamilyDefinition near_default(tiling::FamilyDefinition definition) {
  constexpr double fraction = 1e-3;  // of the box
  for (auto& [description, range] : definition.parameters) {
    const double reach = fraction * (range.upper - range.lower);
    range.lower = std::max(range.lower, range.preset - reach);
    range.upper = std::min(range.upper, range.preset + reach);
  }
  return definition;
}

/// The places to avoid. Vertices are affine functions of the parameters, so that tiles which match around the default
/// match everywhere; faults farther away come from tiles that cross themselves or are turned inside out. Throws if
/// there are faults around the default.
std::vector<tiling::DefinitionFinding> checked_warnings(const tiling::Family& family, const Execution& execution) {
  if (!family.definition) return {};
  const Execution unreported{.cancellation = execution.cancellation, .cost = execution.cost};
  auto report = tiling::check_definition(*family.definition, unreported);
  if (report.good()) return std::move(report.warnings);
  if (!tiling::check_definition(near_default(*family.definition), unreported).good()) {
    std::vector<Error::Detail> details;
    for (const auto& fault : report.faults) details.push_back({fault.where, fault.message});
    throw Error("atlas.faulty_definition", "The definition is none of a family.", std::move(details));
  }
  return std::move(report.faults);
}

std::vector<AtlasProfile> nearest_profiles(const std::vector<AtlasSample>& samples) {
  std::vector<AtlasProfile> profiles;
  for (const ReferenceProfile& reference : reference_profiles()) {
    std::optional<AtlasProfile> nearest;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!samples[i].compliance) continue;
      const double limit = nearest ? nearest->distance.deviation : std::numeric_limits<double>::infinity();
      const ProfileDistance here = distance(*samples[i].compliance, reference, limit);
      if (!nearest || here.deviation < nearest->distance.deviation)
        nearest = AtlasProfile{std::string(reference.name), i, here};
    }
    if (nearest) profiles.push_back(std::move(*nearest));
  }
  return profiles;
}

void bill_effects(const FamilyAtlas& atlas, const AtlasOptions& options, bool has_definition,
                  const Execution& execution) {
  if (!execution.cost) return;
  const auto crossings = static_cast<std::int64_t>(atlas.count(AtlasPlace::crossing));
  execution.cost->add_effect("crossings", options.crossings && crossings > 0,
                             options.crossings ? "tilings that cross themselves are solved, too"
                             : has_definition  ? "tilings that cross themselves are left out"
                                               : "the family has no definition to check",
                             options.crossings ? crossings : 0);
  const auto second = std::count_if(atlas.samples.begin(), atlas.samples.end(),
                                    [](const AtlasSample& sample) { return sample.error.has_value(); });
  execution.cost->add_effect("second_mesh", second > 0,
                             options.error_samples > 0 ? "the error of the mesh is measured at the first samples"
                                                       : "no error of the mesh is asked for",
                             second);
  execution.cost->add_quantity("samples", static_cast<double>(atlas.samples.size()));
}

}  // namespace

std::size_t FamilyAtlas::count(AtlasPlace place) const {
  return static_cast<std::size_t>(std::count_if(samples.begin(), samples.end(),
                                                [place](const AtlasSample& sample) { return sample.place == place; }));
}

FamilyAtlas make_atlas(const tiling::Family& family, const AtlasOptions& options, const Execution& execution) {
  check_options(options);
  FamilyAtlas atlas;
  atlas.family = family.id;
  atlas.bounds = family.parameters;
  atlas.mesh_size = options.mesh_size;
  atlas.crossings = options.crossings;
  execution.checkpoint(0, "survey");
  atlas.warnings = checked_warnings(family, execution);
  // A family without parameters has one member.
  const int count = family.parameters.empty() ? 1 : options.samples;
  std::vector<std::optional<AtlasSample>> samples(static_cast<std::size_t>(count));
  const auto has_one = [&] {
    return std::any_of(samples.begin(), samples.end(), [](const auto& sample) { return sample.has_value(); });
  };
  atlas.stopped = search_until_stopped(execution.cancellation, has_one, [&] {
    parallel_tasks(count, execution, "samples", [&](int index, const Execution& inner) {
      samples[static_cast<std::size_t>(index)] = take_sample(family, index, options, inner);
    });
  });
  for (auto& sample : samples)
    if (sample) atlas.samples.push_back(std::move(*sample));
  atlas.profiles = nearest_profiles(atlas.samples);
  bill_effects(atlas, options, family.definition != nullptr, execution);
  return atlas;
}

tiling::FamilyDefinition atlas_definition(const tiling::IsohedralType& type) {
  constexpr double reach = 0.35;
  constexpr double min_relative_width = 0.05, max_relative_width = 0.2, default_relative_width = 0.1;
  auto definition = tiling::definition_of(type, reach, 0);
  definition.id = "type-" + std::to_string(type.number);
  const tiling::Polygon tile = tiling::tiling_at(definition, type.defaults).tiles[0];
  double perimeter = 0;
  for (std::size_t k = 0; k < tile.size(); ++k) perimeter += (tile[(k + 1) % tile.size()] - tile[k]).norm();
  const double side = perimeter / static_cast<double>(tile.size());
  definition.beam_width.slopes.assign(type.defaults.size() + 1, 0.0);
  definition.beam_width.slopes.back() = side;
  definition.parameters.push_back({"Width of the beams, relative to the mean side of the default tile",
                                   {min_relative_width, max_relative_width, default_relative_width}});
  return definition;
}

}  // namespace supple::design
