#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace supple::neural {

/// A measure of a tile. It is a smooth function of the vertices everywhere, also if the tile crosses itself and where
/// lengths vanish. With w the beam width, smooth lengths are |x|_w = sqrt(|x|^2 + (w/4)^2). Edge k goes from vertex k
/// to the next one.
enum class FeatureKind {
  length,         ///< |edge|_w / w
  log_length,     ///< its logarithm
  direction_cos,  ///< cos 2t of the edge's angle t, times |edge|^2 / |edge|_w^2
  direction_sin,  ///< sin 2t, likewise
  corner_cos,     ///< scalar product of the edges at a vertex over the product of their smooth lengths
  corner_sin,     ///< their cross product, likewise
  log_gap,        ///< ln (|d|_w / w), where d leads from an edge's nearest point to a vertex; that point is clamped
                  ///< smoothly to the edge
  side,           ///< the side of an edge on which a vertex lies: a smooth sine of the angle between edge and vertex
  density,  ///< ratio of the beams' area to the cell's, with overlaps counted twice: w tiles sum |edge|_w / (2 |cell|)
  log_density,  ///< its logarithm
};
std::string_view to_string(FeatureKind kind);
/// Throws "model.invalid_network", which lists the known ones.
FeatureKind feature_kind_of(std::string_view name);

/// One feature, an input of a network: (measure - mean) / scale.
struct TileFeature {
  FeatureKind kind = FeatureKind::length;
  int edge = 0;    ///< used by length, direction, gap and side
  int vertex = 0;  ///< used by corner, gap and side
  double mean = 0;
  double scale = 1;
};

/// The tile of a family, and its features. Points are affine functions of the tiling parameters. Each is a matrix of
/// 2 x (1 + parameters): the position at zero parameters, and the derivatives with respect to each of them. Lengths are
/// in tiling units.
struct TileGeometry {
  std::vector<Eigen::Matrix2Xd> vertices;          ///< in order around the tile
  std::array<Eigen::Matrix2Xd, 2> translations{};  ///< translations of the lattice
  int tiles = 1;                                   ///< number of tiles in one cell
  double beam_width = 1;                           ///< tiling units; with slopes the one at zero parameters
  std::vector<double> beam_width_slopes;  ///< its derivative with respect to each parameter; empty if it is constant
  std::vector<TileFeature> features;

  bool empty() const { return features.empty(); }
};

/// Evaluates the features at these tiling parameters. The result is features x (1 or 1 + parameters): the first column
/// has the features and, if asked for, the others have their derivatives with respect to each parameter. About 300
/// flops for each feature.
Eigen::MatrixXd evaluate_features(const TileGeometry& geometry, std::span<const double> parameters,
                                  bool with_derivatives);

/// Throws "model.invalid_network" unless all points have a column more than there are bounds, features name edges and
/// vertices that exist, all numbers are finite, and beams have a width within the bounds of the parameters.
void validate(const TileGeometry& geometry, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

}  // namespace supple::neural
