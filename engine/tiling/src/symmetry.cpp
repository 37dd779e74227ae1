#include "supple/tiling/symmetry.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <utility>

namespace supple::tiling {
namespace {

/// Tolerance of equality, in tiling units and in parameters.
constexpr double equality_tolerance = 1e-7;

/// The rotations by multiples of 30 degrees, and the reflections in lines that are 30 degrees apart through the origin:
/// the candidates for symmetries, which are tested below.
std::vector<Eigen::Matrix2d> point_operations() {
  std::vector<Eigen::Matrix2d> operations;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(i * std::numbers::pi / 6).toRotationMatrix();
    operations.push_back(rotation);
    operations.push_back(rotation * Eigen::Vector2d(1, -1).asDiagonal());
  }
  return operations;
}

Tiling tiling_at(const Family& family, const Eigen::VectorXd& parameters) {
  return family.shape({parameters.data(), static_cast<std::size_t>(parameters.size())});
}

/// Parameters away from the middle of the box, where a family may have more symmetry than elsewhere.
Eigen::VectorXd generic_parameters(const Family& family, double fraction) {
  Eigen::VectorXd p(static_cast<long>(family.parameters.size()));
  for (long k = 0; k < p.size(); ++k) {
    const auto& [lower, upper, preset] = family.parameters[static_cast<std::size_t>(k)];
    p[k] = preset + (fraction + 0.071 * static_cast<double>(k)) * (upper - preset);
  }
  return p;
}

/// An edge of a tiling: its middle, and the vector between its ends, whose sign is arbitrary.
struct TilingEdge {
  Eigen::Vector2d middle;
  Eigen::Vector2d vector;
};

std::vector<TilingEdge> edges_of(const Tiling& tiling) {
  std::vector<TilingEdge> edges;
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

/// Whether `operation`, followed by some translation, carries each edge of one tiling to an edge of the other.
bool maps_to(const Eigen::Matrix2d& operation, const Tiling& from, const Tiling& to) {
  const Eigen::Matrix2d inverse = to.lattice.inverse();
  const Eigen::Matrix2d lattices = inverse * operation * from.lattice;
  if ((lattices - lattices.array().round().matrix()).norm() > equality_tolerance) return false;
  const auto edges = edges_of(from);
  const auto targets = edges_of(to);
  if (edges.size() != targets.size() || edges.empty()) return false;
  const auto is_edge = [&](const TilingEdge& image) {
    return std::any_of(targets.begin(), targets.end(), [&](const TilingEdge& edge) {
      const Eigen::Vector2d difference = inverse * (image.middle - edge.middle);
      return (difference - difference.array().round().matrix()).norm() < equality_tolerance &&
             std::min((image.vector - edge.vector).norm(), (image.vector + edge.vector).norm()) < equality_tolerance;
    });
  };
  return std::any_of(targets.begin(), targets.end(), [&](const TilingEdge& target) {
    const Eigen::Vector2d translation = target.middle - operation * edges[0].middle;
    return std::all_of(edges.begin(), edges.end(), [&](const TilingEdge& edge) {
      return is_edge({operation * edge.middle + translation, operation * edge.vector});
    });
  });
}

/// The first tile's vertices as functions of the parameters: constant + slopes * p, with x and y of each in turn.
struct AffineTile {
  Eigen::VectorXd constant;
  Eigen::MatrixXd slopes;
};

/// The first tile of a family. If its vertices are not affine functions, the result is their linearization at p.
AffineTile affine_tile(const Family& family, const Eigen::VectorXd& p) {
  const auto vertices = [&](const Eigen::VectorXd& at) {
    const auto tile = tiling_at(family, at).tiles[0];
    Eigen::VectorXd v(2 * static_cast<long>(tile.size()));
    for (std::size_t i = 0; i < tile.size(); ++i) v.segment<2>(2 * static_cast<long>(i)) = tile[i];
    return v;
  };
  constexpr double step = 1e-3;
  AffineTile tile{vertices(p), {}};
  tile.slopes.resize(tile.constant.size(), p.size());
  for (long k = 0; k < p.size(); ++k)
    tile.slopes.col(k) = (vertices(p + step * Eigen::VectorXd::Unit(p.size(), k)) - tile.constant) / step;
  tile.constant -= tile.slopes * p;
  return tile;
}

/// The parameters that no vertex depends on, such as the width of the beams.
std::vector<long> parameters_without_effect(const AffineTile& tile) {
  std::vector<long> result;
  for (long k = 0; k < tile.slopes.cols(); ++k)
    if (tile.slopes.col(k).cwiseAbs().maxCoeff() < equality_tolerance) result.push_back(k);
  return result;
}

/// An affine map of the parameters, as {linear, constant}.
using ParameterMap = std::pair<Eigen::MatrixXd, Eigen::VectorXd>;

/// The map p -> p' such that the tile at p' is, up to a translation, the tile at p rotated or reflected, with vertex i
/// at the image of vertex `first` + i, or `first` - i if reflected. Parameters that no vertex depends on stay as they
/// are. None if there is no such map.
std::optional<ParameterMap> parameter_map(const AffineTile& tile, const Eigen::Matrix2d& operation, long first) {
  const long n = tile.constant.size() / 2;
  const long parameters = tile.slopes.cols();
  const bool reflects = operation.determinant() < 0;
  const std::vector<long> fixed = parameters_without_effect(tile);
  const long rows = 2 * n + static_cast<long>(fixed.size());
  // The unknowns are the new parameters and a translation. The right-hand sides belong to the old parameters and to the
  // constant.
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows, parameters + 2);
  Eigen::MatrixXd image = Eigen::MatrixXd::Zero(rows, parameters + 1);
  for (std::size_t k = 0; k < fixed.size(); ++k) {
    const long row = 2 * n + static_cast<long>(k);
    matrix(row, fixed[k]) = 1;
    image(row, fixed[k]) = 1;
  }
  for (long i = 0; i < n; ++i) {
    const long from = (first + (reflects ? n - i : i)) % n;
    matrix.block(2 * i, 0, 2, parameters) = tile.slopes.middleRows(2 * i, 2);
    matrix.block<2, 2>(2 * i, parameters).setIdentity();
    image.block(2 * i, 0, 2, parameters) = operation * tile.slopes.middleRows(2 * from, 2);
    image.block<2, 1>(2 * i, parameters) =
        operation * tile.constant.segment<2>(2 * from) - tile.constant.segment<2>(2 * i);
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(matrix);
  if (solver.rank() < matrix.cols()) return std::nullopt;
  const Eigen::MatrixXd map = solver.solve(image);
  if ((matrix * map - image).cwiseAbs().maxCoeff() > equality_tolerance) return std::nullopt;
  return ParameterMap{map.topLeftCorner(parameters, parameters), map.topRightCorner(parameters, 1)};
}

/// All such maps, beginning with the identity.
std::vector<ParameterMap> parameter_maps(const AffineTile& tile) {
  const long parameters = tile.slopes.cols();
  std::vector<ParameterMap> maps{
      {Eigen::MatrixXd::Identity(parameters, parameters), Eigen::VectorXd::Zero(parameters)}};
  for (const auto& operation : point_operations())
    for (long first = 0; first < tile.constant.size() / 2; ++first) {
      const auto map = parameter_map(tile, operation, first);
      if (map && std::none_of(maps.begin(), maps.end(), [&](const ParameterMap& known) {
            return (known.first - map->first).norm() + (known.second - map->second).norm() < equality_tolerance;
          }))
        maps.push_back(*map);
    }
  return maps;
}

}  // namespace

std::vector<FamilySymmetry> symmetries(const Family& family) {
  const std::array samples{generic_parameters(family, 0.137), generic_parameters(family, 0.311)};
  std::vector<FamilySymmetry> result;
  for (const auto& [linear, constant] : parameter_maps(affine_tile(family, samples[0])))
    for (const auto& operation : point_operations()) {
      const FamilySymmetry symmetry{operation, linear, constant};
      if (std::all_of(samples.begin(), samples.end(), [&](const Eigen::VectorXd& p) {
            return maps_to(operation, tiling_at(family, p), tiling_at(family, symmetry.image(p)));
          }))
        result.push_back(symmetry);
    }
  return result;
}

}  // namespace supple::tiling
