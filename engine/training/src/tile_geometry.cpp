#include "supple/training/tile_geometry.h"

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/sobol.h"
#include "supple/tiling/family_definition.h"

namespace supple::training {
namespace {

using neural::FeatureKind;
using neural::TileGeometry;

/// Fraction of its width by which the parameter box is widened on either side.
constexpr double box_margin = 0.05;
/// Number of designs in the widened box over which features are compared and normalized.
constexpr int compared_designs = 512;
/// Features are linear functions of each other if their absolute correlation differs from 1 by less than this.
constexpr double correlation_tolerance = 1e-9;
/// A feature is constant but for rounding if its standard deviation over the box is not above this.
constexpr double min_deviation = 1e-9;
/// Largest distance, in tiling units, of a vertex that is affine in the parameters from its affine prediction.
constexpr double position_tolerance = 1e-9;

Eigen::Matrix2Xd points_of(const tiling::Tiling& tiling) {
  Eigen::Matrix2Xd points(2, static_cast<long>(tiling.tiles.front().size()) + 2);
  for (std::size_t k = 0; k < tiling.tiles.front().size(); ++k) points.col(static_cast<long>(k)) = tiling.tiles[0][k];
  points.rightCols<2>() = tiling.lattice;
  return points;
}

[[noreturn]] void throw_not_affine(const tiling::Family& family) {
  throw Error(
      "training.no_features",
      fmt::format("Tiles of the family {} are not one polygon whose vertices move linearly with the parameters; "
                  "its networks have no features.",
                  family.id),
      {{"features", "none for this family"}});
}

/// Vertices and translations as affine functions of the parameters, computed from finite differences. Throws unless two
/// other designs agree with them.
TileGeometry without_features(const tiling::Family& family) {
  const auto n = family.parameters.size();
  std::vector<double> lower(n);
  std::vector<double> upper(n);
  std::vector<double> interior(n);
  for (std::size_t k = 0; k < n; ++k) {
    lower[k] = family.parameters[k].lower;
    upper[k] = family.parameters[k].upper;
    interior[k] = lower[k] + (0.3 + 0.1 * static_cast<double>(k)) * (upper[k] - lower[k]);
  }
  const auto tiling = family.shape(lower);
  if (tiling.tiles.size() != 1) throw_not_affine(family);
  const auto points_at = [&](const std::vector<double>& parameters) {
    const auto other_tiling = family.shape(parameters);
    if (other_tiling.tiles.size() != 1 || other_tiling.tiles.front().size() != tiling.tiles.front().size())
      throw_not_affine(family);
    return points_of(other_tiling);
  };
  Eigen::Matrix2Xd constant = points_of(tiling);
  const auto at_lower = constant;
  std::vector<Eigen::Matrix2Xd> derivatives;
  for (std::size_t k = 0; k < n; ++k) {
    auto shifted = lower;
    shifted[k] = upper[k];
    derivatives.emplace_back((points_at(shifted) - at_lower) / (upper[k] - lower[k]));
    constant -= derivatives.back() * lower[k];
  }
  for (const auto& other : {interior, upper}) {
    Eigen::Matrix2Xd expected = constant;
    for (std::size_t k = 0; k < n; ++k) expected += derivatives[k] * other[k];
    if ((points_at(other) - expected).cwiseAbs().maxCoeff() > position_tolerance) throw_not_affine(family);
  }
  const auto affine = [&](long point) {
    Eigen::Matrix2Xd columns(2, 1 + static_cast<long>(n));
    columns.col(0) = constant.col(point);
    for (std::size_t k = 0; k < n; ++k) columns.col(1 + static_cast<long>(k)) = derivatives[k].col(point);
    return columns;
  };
  TileGeometry geometry;
  const long corners = constant.cols() - 2;
  for (long k = 0; k < corners; ++k) geometry.vertices.push_back(affine(k));
  geometry.translations = {affine(corners), affine(corners + 1)};
  geometry.tiles = static_cast<int>(tiling.placements.size());
  geometry.beam_width = family.beam_width;
  if (family.definition && !family.definition->beam_width.slopes.empty()) {
    geometry.beam_width = family.definition->beam_width.constant;
    geometry.beam_width_slopes = family.definition->beam_width.slopes;
    geometry.beam_width_slopes.resize(n);
  }
  return geometry;
}

void add_candidates(TileGeometry& geometry) {
  const auto corners = static_cast<int>(geometry.vertices.size());
  const auto add = [&](FeatureKind kind, int edge, int vertex) {
    geometry.features.push_back({kind, edge, vertex, 0, 1});
  };
  for (const auto kind :
       {FeatureKind::length, FeatureKind::log_length, FeatureKind::direction_cos, FeatureKind::direction_sin})
    for (int edge = 0; edge < corners; ++edge) add(kind, edge, 0);
  for (const auto kind : {FeatureKind::corner_cos, FeatureKind::corner_sin})
    for (int vertex = 0; vertex < corners; ++vertex) add(kind, 0, vertex);
  for (const auto kind : {FeatureKind::log_gap, FeatureKind::side})
    for (int edge = 0; edge < corners; ++edge)
      for (int vertex = 0; vertex < corners; ++vertex)
        if (vertex != edge && vertex != (edge + 1) % corners) add(kind, edge, vertex);
  add(FeatureKind::density, 0, 0);
  add(FeatureKind::log_density, 0, 0);
}

}  // namespace

TileGeometry tile_geometry(const tiling::Family& family) {
  auto geometry = without_features(family);
  add_candidates(geometry);
  const SobolSequence sequence("features of tiles", 1);
  Eigen::MatrixXd values(static_cast<long>(geometry.features.size()), compared_designs);
  std::vector<double> parameters(family.parameters.size());
  for (int d = 0; d < compared_designs; ++d) {
    const auto point = sequence.point(static_cast<std::uint32_t>(d));
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      const auto& [lower, upper, preset] = family.parameters[k];
      parameters[k] = lower + (upper - lower) * (point[k] * (1 + 2 * box_margin) - box_margin);
    }
    values.col(d) = evaluate_features(geometry, parameters, false);
  }
  std::vector<neural::TileFeature> retained;
  std::vector<Eigen::VectorXd>
      retained_profiles;  // values of the retained features, centred and normalized to length 1
  for (long i = 0; i < values.rows(); ++i) {
    auto feature = geometry.features[static_cast<std::size_t>(i)];
    feature.mean = values.row(i).mean();
    const Eigen::VectorXd differences = values.row(i).array() - feature.mean;
    feature.scale = differences.norm() / std::sqrt(static_cast<double>(compared_designs));
    if (!(feature.scale > min_deviation)) continue;
    const Eigen::VectorXd profile = differences.normalized();
    bool is_redundant = false;
    for (const auto& other : retained_profiles)
      is_redundant = is_redundant || 1 - std::abs(profile.dot(other)) < correlation_tolerance;
    if (is_redundant) continue;
    retained.push_back(feature);
    retained_profiles.push_back(profile);
  }
  geometry.features = std::move(retained);
  return geometry;
}

}  // namespace supple::training
