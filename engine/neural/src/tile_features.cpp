#include "supple/neural/tile_features.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "supple/base/error.h"
#include "supple/neural/network.h"

namespace supple::neural {
namespace {

constexpr std::array<std::pair<FeatureKind, std::string_view>, 10> names{{{FeatureKind::length, "length"},
                                                                          {FeatureKind::log_length, "log_length"},
                                                                          {FeatureKind::direction_cos, "direction_cos"},
                                                                          {FeatureKind::direction_sin, "direction_sin"},
                                                                          {FeatureKind::corner_cos, "corner_cos"},
                                                                          {FeatureKind::corner_sin, "corner_sin"},
                                                                          {FeatureKind::log_gap, "log_gap"},
                                                                          {FeatureKind::side, "side"},
                                                                          {FeatureKind::density, "density"},
                                                                          {FeatureKind::log_density, "log_density"}}};

/// Ratio to the beam width of the length below which lengths are smoothed. Joints are about as large as the beam is
/// wide.
constexpr double smoothing_ratio = 0.25;
/// Sharpness of the clamping of the nearest point to an edge, in units of 1 / edge length.
constexpr double end_sharpness = 20;
/// Limits of sizes that are read from files. Tiles have far fewer corners.
constexpr std::size_t max_vertices = 64;
constexpr std::size_t max_features = 1024;

/// A number and its derivatives with respect to the tiling parameters.
struct DualNumber {
  double value = 0;
  Eigen::Array<double, max_parameters, 1> by = Eigen::Array<double, max_parameters, 1>::Zero();
};
DualNumber operator+(const DualNumber& a, const DualNumber& b) { return {a.value + b.value, a.by + b.by}; }
DualNumber operator-(const DualNumber& a, const DualNumber& b) { return {a.value - b.value, a.by - b.by}; }
DualNumber operator*(const DualNumber& a, const DualNumber& b) {
  return {a.value * b.value, a.by * b.value + b.by * a.value};
}
DualNumber operator/(const DualNumber& a, const DualNumber& b) {
  const double quotient = a.value / b.value;
  return {quotient, (a.by - quotient * b.by) / b.value};
}
DualNumber operator+(const DualNumber& a, double b) { return {a.value + b, a.by}; }
DualNumber operator*(const DualNumber& a, double b) { return {a.value * b, a.by * b}; }
DualNumber inverse(const DualNumber& a) {
  const double value = 1 / a.value;
  return {value, a.by * (-value * value)};
}
DualNumber sqrt(const DualNumber& a) {
  const double root = std::sqrt(a.value);
  return {root, a.by / (2 * root)};
}
DualNumber log(const DualNumber& a) { return {std::log(a.value), a.by / a.value}; }
/// log(1 + exp x), without overflow.
DualNumber softplus(const DualNumber& a) {
  const double slope = a.value >= 0 ? 1 / (1 + std::exp(-a.value)) : 1 - 1 / (1 + std::exp(a.value));
  return {std::max(a.value, 0.0) + std::log1p(std::exp(-std::abs(a.value))), a.by * slope};
}

struct DualVector {
  DualNumber x;
  DualNumber y;
};
DualVector operator-(const DualVector& a, const DualVector& b) { return {a.x - b.x, a.y - b.y}; }
DualVector operator*(const DualVector& a, const DualNumber& b) { return {a.x * b, a.y * b}; }
DualNumber dot(const DualVector& a, const DualVector& b) { return a.x * b.x + a.y * b.y; }
DualNumber cross(const DualVector& a, const DualVector& b) { return a.x * b.y - a.y * b.x; }

DualVector point_at(const Eigen::Matrix2Xd& point, std::span<const double> parameters) {
  DualVector at;
  at.x.value = point(0, 0);
  at.y.value = point(1, 0);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto i = static_cast<long>(k);
    at.x.value += point(0, 1 + i) * parameters[k];
    at.y.value += point(1, 1 + i) * parameters[k];
    at.x.by[i] = point(0, 1 + i);
    at.y.by[i] = point(1, 1 + i);
  }
  return at;
}

DualNumber width_at(const TileGeometry& geometry, std::span<const double> parameters) {
  DualNumber width{.value = geometry.beam_width};
  for (std::size_t k = 0; k < geometry.beam_width_slopes.size(); ++k) {
    width.value += geometry.beam_width_slopes[k] * parameters[k];
    width.by[static_cast<long>(k)] = geometry.beam_width_slopes[k];
  }
  return width;
}

/// The tile at given parameters, with quantities that several features use.
class TileAt {
 public:
  TileAt(const TileGeometry& geometry, std::span<const double> parameters) {
    const auto width = width_at(geometry, parameters);
    inverse_width_ = inverse(width);
    squared_smoothing_ = width * smoothing_ratio * smoothing_ratio * width;
    for (const auto& vertex : geometry.vertices) vertices_.push_back(point_at(vertex, parameters));
    DualNumber perimeter;
    for (std::size_t k = 0; k < vertices_.size(); ++k) {
      edges_.push_back(vertices_[(k + 1) % vertices_.size()] - vertices_[k]);
      lengths_.push_back(smooth_length(edges_.back()));
      perimeter = perimeter + lengths_.back();
    }
    const auto cell =
        cross(point_at(geometry.translations[0], parameters), point_at(geometry.translations[1], parameters));
    const auto smoothing_area = width * smoothing_ratio * width;
    // Each beam belongs to two tiles.
    density_ = perimeter * (width * 0.5 * geometry.tiles) / sqrt(cell * cell + smoothing_area * smoothing_area);
  }

  DualNumber measure(const TileFeature& feature) const {
    const auto edge = static_cast<std::size_t>(feature.edge);
    const auto vertex = static_cast<std::size_t>(feature.vertex);
    switch (feature.kind) {
      case FeatureKind::length:
        return lengths_[edge] * inverse_width_;
      case FeatureKind::log_length:
        return log(lengths_[edge] * inverse_width_);
      case FeatureKind::direction_cos:
        return (edges_[edge].x * edges_[edge].x - edges_[edge].y * edges_[edge].y) / (lengths_[edge] * lengths_[edge]);
      case FeatureKind::direction_sin:
        return edges_[edge].x * edges_[edge].y * 2 / (lengths_[edge] * lengths_[edge]);
      case FeatureKind::corner_cos:
        return dot(edges_[before(vertex)], edges_[vertex]) / (lengths_[before(vertex)] * lengths_[vertex]);
      case FeatureKind::corner_sin:
        return cross(edges_[before(vertex)], edges_[vertex]) / (lengths_[before(vertex)] * lengths_[vertex]);
      case FeatureKind::log_gap:
        return log(smooth_length(from_edge(edge, vertex)) * inverse_width_);
      case FeatureKind::side:
        return cross(edges_[edge], vertices_[vertex] - vertices_[edge]) /
               (lengths_[edge] * smooth_length(from_edge(edge, vertex)));
      case FeatureKind::density:
        return density_;
      default:
        return log(density_);
    }
  }

 private:
  std::size_t before(std::size_t vertex) const { return (vertex + vertices_.size() - 1) % vertices_.size(); }
  DualNumber smooth_length(const DualVector& x) const { return sqrt(dot(x, x) + squared_smoothing_); }
  /// The vector from the edge's nearest point to the vertex.
  DualVector from_edge(std::size_t edge, std::size_t vertex) const {
    const auto x = vertices_[vertex] - vertices_[edge];
    const auto place = dot(x, edges_[edge]) / (lengths_[edge] * lengths_[edge]) * end_sharpness;
    const auto within = (softplus(place) - softplus(place + -end_sharpness)) * (1 / end_sharpness);
    return x - edges_[edge] * within;
  }

  DualNumber inverse_width_;
  DualNumber squared_smoothing_;
  std::vector<DualVector> vertices_;
  std::vector<DualVector> edges_;
  std::vector<DualNumber> lengths_;
  DualNumber density_;
};

void check(bool fine, const char* what) {
  if (!fine) throw Error("model.invalid_network", std::string("geometry: ") + what + ".", {{"geometry", what}});
}

}  // namespace

std::string_view to_string(FeatureKind kind) { return names[static_cast<std::size_t>(kind)].second; }

FeatureKind feature_kind_of(std::string_view name) {
  std::string known;
  for (const auto& [kind, each] : names) {
    if (each == name) return kind;
    known += (known.empty() ? "" : ", ") + std::string(each);
  }
  throw Error("model.invalid_network",
              "There is no feature of tiles " + std::string(name) + "; the features are " + known + ".");
}

Eigen::MatrixXd evaluate_features(const TileGeometry& geometry, std::span<const double> parameters,
                                  bool with_derivatives) {
  const auto n = static_cast<long>(parameters.size());
  Eigen::MatrixXd features(static_cast<long>(geometry.features.size()), with_derivatives ? 1 + n : 1);
  const TileAt tile(geometry, parameters);
  for (long i = 0; i < features.rows(); ++i) {
    const auto& feature = geometry.features[static_cast<std::size_t>(i)];
    const auto measured = tile.measure(feature);
    features(i, 0) = (measured.value - feature.mean) / feature.scale;
    for (long k = 0; k + 1 < features.cols(); ++k) features(i, 1 + k) = measured.by[k] / feature.scale;
  }
  return features;
}

void validate(const TileGeometry& geometry, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  const auto point = [&](const Eigen::Matrix2Xd& affine) {
    return affine.cols() == 1 + lower.size() && affine.allFinite();
  };
  check(geometry.vertices.size() >= 3 && geometry.vertices.size() <= max_vertices, "has no 3 to 64 vertices");
  check(std::all_of(geometry.vertices.begin(), geometry.vertices.end(), point) &&
            std::all_of(geometry.translations.begin(), geometry.translations.end(), point),
        "points must be finite, with a column more than there are parameters");
  check(geometry.tiles >= 1 && geometry.tiles <= 1000, "must have 1 to 1000 tiles in a cell");
  const auto& slopes = geometry.beam_width_slopes;
  check(slopes.empty() || static_cast<long>(slopes.size()) == lower.size(),
        "the beam width must have a slope for each parameter, or none");
  double least = geometry.beam_width;
  for (std::size_t k = 0; k < slopes.size(); ++k)
    least += std::min(slopes[k] * lower[static_cast<long>(k)], slopes[k] * upper[static_cast<long>(k)]);
  check(std::isfinite(least) && least > 0, "the beam width must be positive within the bounds");
  check(geometry.features.size() <= max_features, "has more than 1024 features");
  const auto corners = static_cast<int>(geometry.vertices.size());
  for (const auto& feature : geometry.features) {
    check(feature.edge >= 0 && feature.edge < corners && feature.vertex >= 0 && feature.vertex < corners,
          "a feature names an edge or vertex that the tile has not");
    check(std::isfinite(feature.mean) && std::isfinite(feature.scale) && feature.scale > 0,
          "a feature's mean must be finite and its scale positive");
  }
}

}  // namespace supple::neural
