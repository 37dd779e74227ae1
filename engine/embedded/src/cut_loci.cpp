#include "cut_loci.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "supple/surface/retraction.h"

namespace supple::embedded {
namespace {

using Eigen::Vector4d;
using surface::TangentGeodesic;

/// Distances from a cut locus, in mean edges, at which its shortest paths are looked for, the smallest first: beside it
/// each of them is the only shortest one, and far enough from it rounding does not hide which.
constexpr std::array side_distances{1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1};
/// Two paths are the same if their gradients differ by less than this plus `gradient_change` times the distance at
/// which they were found over their length. The second part is what crossing other edges may change.
constexpr double same_gradient = 1e-6;
constexpr double gradient_change = 1;
/// Relative difference of lengths that are equal but for rounding.
constexpr double equal_lengths = 1e-14;
/// Relative difference of lengths above which a cut locus is forgotten after the last adjustment.
constexpr double max_length_difference = 1e-11;
constexpr int max_adjustments = 12;

/// The part of a change that moves free ends.
Vector4d free_part(const Vector4d& change, const CutLocus& locus, const std::vector<bool>& fixed) {
  Vector4d part = change;
  if (fixed[static_cast<std::size_t>(locus.from)]) part.head<2>().setZero();
  if (fixed[static_cast<std::size_t>(locus.to)]) part.tail<2>().setZero();
  return part;
}

/// The shortest path between the ends moved by `offset`, continued back to the ends themselves.
std::optional<TangentGeodesic> shortest_beside(const CutLocusContext& context, const NetworkState& state,
                                               const CutLocus& locus, const Vector4d& offset) {
  const auto& points = state.points();
  const auto walk = [&](std::int32_t point, const Eigen::Vector2d& step) -> surface::Retraction {
    const surface::SurfacePoint& at = points[static_cast<std::size_t>(point)];
    if (step.isZero(0)) return {at, step};
    return surface::retract(context.solver.mesh(), at, step, state.cancellation());
  };
  const surface::Retraction from = walk(locus.from, offset.head<2>());
  const surface::Retraction to = walk(locus.to, offset.tail<2>());
  if (!from.isometric || !to.isometric) return std::nullopt;
  const surface::PointPair pair{from.end, to.end};
  TangentGeodesic found;
  context.solver.tangent_geodesics({&pair, 1}, {&found, 1}, false);
  if (!std::isfinite(found.distance) || !(found.distance > offset.norm())) return std::nullopt;
  return found.in_frames_before(from.turn, to.turn).extrapolated(-offset);
}

bool are_different(const std::vector<TangentGeodesic>& paths, double distance) {
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if ((paths[i].gradient() - paths[j].gradient()).norm() <
          same_gradient + gradient_change * distance / paths[i].distance)
        return false;
  return true;
}

/// One shortest path for each side of a cut locus, all different; empty where these are not found.
std::vector<TangentGeodesic> paths_beside(const CutLocusContext& context, const NetworkState& state,
                                          const CutLocus& locus) {
  const double edge = context.solver.mesh().mean_edge_length();
  for (const double distance : side_distances) {
    std::vector<TangentGeodesic> paths;
    for (const Vector4d& side : locus.sides) {
      const auto path = shortest_beside(context, state, locus, distance * edge * side);
      if (!path) return {};
      paths.push_back(*path);
    }
    if (are_different(paths, distance * edge)) return paths;
  }
  return {};
}

/// The constraints that the lengths at each cut locus are equal, one for each path after the first.
struct EqualLengths {
  Eigen::VectorXd excess;            ///< lengths minus that of the first path
  Eigen::MatrixXd jacobian;          ///< derivatives of the excess by the coordinates of `points`
  std::vector<std::int32_t> points;  ///< ends of the paths
  double shortest = 0;               ///< least length of all paths

  Eigen::Index row_of(std::int32_t point) const { return 2 * (std::ranges::find(points, point) - points.begin()); }
};

EqualLengths equal_lengths_of(const std::vector<CutLocus>& loci, const std::vector<EqualPaths>& equal,
                              const std::vector<bool>& fixed) {
  EqualLengths constraints;
  Eigen::Index count = 0;
  constraints.shortest = equal.front().geodesics.front().distance;
  for (std::size_t k = 0; k < loci.size(); ++k) {
    constraints.shortest = std::min(constraints.shortest, equal[k].geodesics.front().distance);
    for (const std::int32_t point : {loci[k].from, loci[k].to})
      if (std::ranges::find(constraints.points, point) == constraints.points.end()) constraints.points.push_back(point);
    count += static_cast<Eigen::Index>(equal[k].geodesics.size()) - 1;
  }
  constraints.excess.resize(count);
  constraints.jacobian.setZero(count, 2 * static_cast<Eigen::Index>(constraints.points.size()));
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < loci.size(); ++k) {
    const auto& paths = equal[k].geodesics;
    for (std::size_t b = 1; b < paths.size(); ++b, ++row) {
      constraints.excess[row] = paths[b].distance - paths[0].distance;
      const Vector4d difference = free_part(paths[b].gradient() - paths[0].gradient(), loci[k], fixed);
      constraints.jacobian.block<1, 2>(row, constraints.row_of(loci[k].from)) += difference.head<2>().transpose();
      constraints.jacobian.block<1, 2>(row, constraints.row_of(loci[k].to)) += difference.tail<2>().transpose();
    }
  }
  return constraints;
}

/// The shortest paths of all cut loci at the present points. The state forgets cut loci for which they are not found.
std::vector<EqualPaths> paths_at(const CutLocusContext& context, NetworkState& state) {
  std::vector<CutLocus> retained;
  std::vector<EqualPaths> equal;
  for (const CutLocus& locus : state.cut_loci()) {
    EqualPaths own{.path = locus.path, .geodesics = paths_beside(context, state, locus)};
    if (own.geodesics.empty()) continue;
    CutLocus turned = locus;
    turned.sides = sides_of(own.geodesics, locus, context.fixed);
    if (turned.sides.empty()) continue;
    retained.push_back(std::move(turned));
    equal.push_back(std::move(own));
  }
  state.set_cut_loci(std::move(retained));
  return equal;
}

}  // namespace

std::vector<Vector4d> sides_of(const std::vector<TangentGeodesic>& paths, const CutLocus& locus,
                               const std::vector<bool>& fixed) {
  std::vector<Vector4d> sides;
  for (const TangentGeodesic& own : paths) {
    Vector4d side = Vector4d::Zero();
    for (const TangentGeodesic& other : paths) {
      if (&other == &own) continue;
      const Vector4d away = free_part(other.gradient() - own.gradient(), locus, fixed);
      if (away.norm() < same_gradient) return {};
      side += away.normalized();
    }
    if (side.norm() < same_gradient) return {};
    sides.push_back(side.normalized());
  }
  return sides;
}

std::vector<EqualPaths> return_to_cut_loci(const CutLocusContext& context, NetworkState& state) {
  for (int adjustment = 0;; ++adjustment) {
    std::vector<EqualPaths> equal = paths_at(context, state);
    if (equal.empty()) return {};
    const EqualLengths constraints = equal_lengths_of(state.cut_loci(), equal, context.fixed);
    if (constraints.excess.size() == 0) return equal;
    const double worst = constraints.excess.cwiseAbs().maxCoeff();
    const bool last = adjustment == max_adjustments;
    if (worst <= (last ? max_length_difference : equal_lengths) * constraints.shortest) return equal;
    if (last) {
      state.set_cut_loci({});
      return {};
    }
    const Eigen::VectorXd change = -constraints.jacobian.completeOrthogonalDecomposition().solve(constraints.excess);
    // Where the lengths hardly depend on the ends, the linear system asks for a step that is longer than the paths.
    if (!(change.norm() <= constraints.shortest)) {
      state.set_cut_loci({});
      return {};
    }
    Eigen::VectorXd step = Eigen::VectorXd::Zero(state.dimension());
    for (const std::int32_t point : constraints.points)
      step.segment<2>(2 * point) = change.segment<2>(constraints.row_of(point));
    state.adjust(step);
  }
}

namespace {

/// Forgets the cut loci that the predicate is true for.
template <class Predicate>
void drop_if(NetworkState& state, std::vector<EqualPaths>& equal, const Predicate& is_dropped) {
  std::vector<CutLocus> loci = state.cut_loci();
  std::erase_if(loci, [&](const CutLocus& locus) {
    return is_dropped(*std::ranges::find(equal, locus.path, &EqualPaths::path));
  });
  std::erase_if(equal, is_dropped);
  state.set_cut_loci(std::move(loci));
}

}  // namespace

void drop_non_shortest(NetworkState& state, std::vector<EqualPaths>& equal,
                       const std::vector<TangentGeodesic>& shortest) {
  drop_if(state, equal, [&](const EqualPaths& own) {
    const double least = shortest[own.path].distance;
    return std::abs(own.geodesics.front().distance - least) > max_length_difference * least;
  });
}

void drop_uncompressed(NetworkState& state, std::vector<EqualPaths>& equal, const std::vector<double>& forces) {
  drop_if(state, equal, [&](const EqualPaths& own) { return !(forces[own.path] < 0); });
}

namespace {

/// The convex combinations, one of the columns of each set, whose sum with a given vector is the shortest.
class ShortestSum {
 public:
  ShortestSum(Eigen::VectorXd fixed, std::vector<Eigen::MatrixXd> sets)
      : sum_(std::move(fixed)), sets_(std::move(sets)) {
    for (const Eigen::MatrixXd& set : sets_) {
      weights_.push_back(Eigen::VectorXd::Unit(set.cols(), 0));
      sum_ += set.col(0);
    }
  }

  /// The weights of the combinations.
  std::vector<Eigen::VectorXd> weights() {
    for (int sweep = 0; sweep < max_sweeps && exchange_all() > min_exchange; ++sweep) continue;
    if (const auto exact = weights_on_support()) return *exact;
    return weights_;
  }

 private:
  static constexpr int max_sweeps = 500;
  static constexpr double min_exchange = 1e-10;

  /// Moves weight between every two columns of a set, as much as makes the sum shortest. Returns the largest change.
  double exchange_all() {
    double largest = 0;
    for (std::size_t k = 0; k < sets_.size(); ++k)
      for (Eigen::Index i = 0; i < sets_[k].cols(); ++i)
        for (Eigen::Index j = 0; j < i; ++j) {
          const Eigen::VectorXd difference = sets_[k].col(i) - sets_[k].col(j);
          const double squared = difference.squaredNorm();
          if (!(squared > 0)) continue;
          const double moved = std::clamp(-difference.dot(sum_) / squared, -weights_[k][i], weights_[k][j]);
          weights_[k][i] += moved;
          weights_[k][j] -= moved;
          sum_ += moved * difference;
          largest = std::max(largest, std::abs(moved));
        }
    return largest;
  }

  /// The weights to rounding, by least squares over the columns that have weight now. Nothing where one of these would
  /// get a negative weight.
  std::optional<std::vector<Eigen::VectorXd>> weights_on_support() const {
    std::vector<std::pair<std::size_t, Eigen::Index>> free;
    std::vector<Eigen::Index> first(sets_.size());
    for (std::size_t k = 0; k < sets_.size(); ++k) {
      weights_[k].maxCoeff(&first[k]);
      for (Eigen::Index i = 0; i < sets_[k].cols(); ++i)
        if (i != first[k] && weights_[k][i] > min_exchange) free.emplace_back(k, i);
    }
    std::vector<Eigen::VectorXd> exact(sets_.size());
    for (std::size_t k = 0; k < sets_.size(); ++k) exact[k] = Eigen::VectorXd::Unit(sets_[k].cols(), first[k]);
    if (free.empty()) return exact;
    Eigen::VectorXd fixed = sum_;
    for (std::size_t k = 0; k < sets_.size(); ++k) fixed += sets_[k] * (exact[k] - weights_[k]);
    Eigen::MatrixXd differences(sum_.size(), static_cast<Eigen::Index>(free.size()));
    for (Eigen::Index c = 0; c < differences.cols(); ++c) {
      const auto& [k, i] = free[static_cast<std::size_t>(c)];
      differences.col(c) = sets_[k].col(i) - sets_[k].col(first[k]);
    }
    const Eigen::VectorXd found = -differences.completeOrthogonalDecomposition().solve(fixed);
    for (Eigen::Index c = 0; c < differences.cols(); ++c) {
      const auto& [k, i] = free[static_cast<std::size_t>(c)];
      exact[k][i] = found[c];
      exact[k][first[k]] -= found[c];
    }
    for (const Eigen::VectorXd& own : exact)
      if (!(own.minCoeff() >= 0)) return std::nullopt;
    return exact;
  }

  Eigen::VectorXd sum_;
  std::vector<Eigen::MatrixXd> sets_;  ///< columns
  std::vector<Eigen::VectorXd> weights_;
};

/// The fractions of each force with which the least gradient is left.
std::vector<Eigen::VectorXd> force_fractions(const std::vector<CutLocus>& loci, const std::vector<EqualPaths>& equal,
                                             const Eigen::VectorXd& gradient, const std::vector<double>& forces,
                                             const std::vector<bool>& fixed) {
  const EqualLengths constraints = equal_lengths_of(loci, equal, fixed);
  Eigen::VectorXd others = Eigen::VectorXd::Zero(constraints.jacobian.cols());
  for (const std::int32_t point : constraints.points)
    if (!fixed[static_cast<std::size_t>(point)])
      others.segment<2>(constraints.row_of(point)) = gradient.segment<2>(2 * point);
  std::vector<Eigen::MatrixXd> sets;
  for (std::size_t k = 0; k < equal.size(); ++k) {
    Eigen::MatrixXd set = Eigen::MatrixXd::Zero(others.size(), static_cast<Eigen::Index>(equal[k].geodesics.size()));
    for (Eigen::Index b = 0; b < set.cols(); ++b) {
      const Vector4d force =
          forces[equal[k].path] * free_part(equal[k].geodesics[static_cast<std::size_t>(b)].gradient(), loci[k], fixed);
      set.block<2, 1>(constraints.row_of(loci[k].from), b) = force.head<2>();
      set.block<2, 1>(constraints.row_of(loci[k].to), b) = force.tail<2>();
    }
    others -= set.col(0);
    sets.push_back(std::move(set));
  }
  return ShortestSum(std::move(others), std::move(sets)).weights();
}

/// Forgets the paths without force.
void drop_unused_paths(CutLocus& locus, EqualPaths& equal) {
  Eigen::Index retained = 0;
  for (Eigen::Index b = 0; b < equal.fractions.size(); ++b) {
    if (!(equal.fractions[b] > 0) && !locus.for_next_step) continue;
    const auto to = static_cast<std::size_t>(retained);
    const auto from = static_cast<std::size_t>(b);
    locus.sides[to] = locus.sides[from];
    equal.geodesics[to] = equal.geodesics[from];
    equal.fractions[retained++] = equal.fractions[b];
  }
  locus.for_next_step = false;
  locus.sides.resize(static_cast<std::size_t>(retained));
  equal.geodesics.resize(static_cast<std::size_t>(retained));
  equal.fractions.conservativeResize(retained);
}

/// The length of equally short paths, with the convex combination of their derivatives.
LengthDerivatives combined_length(const EqualPaths& equal) {
  LengthDerivatives result;
  result.length = std::ranges::min_element(equal.geodesics, {}, &TangentGeodesic::distance)->distance;
  for (std::size_t b = 0; b < equal.geodesics.size(); ++b) {
    const double fraction = equal.fractions[static_cast<Eigen::Index>(b)];
    result.gradient += fraction * equal.geodesics[b].gradient();
    result.hessian += fraction * equal.geodesics[b].hessian();
  }
  return result;
}

}  // namespace

void distribute_path_forces(NetworkState& state, std::vector<EqualPaths>& equal, const Eigen::VectorXd& gradient,
                            const std::vector<double>& forces, const std::vector<bool>& fixed) {
  std::vector<CutLocus> loci = state.cut_loci();
  const std::vector<Eigen::VectorXd> fractions = force_fractions(loci, equal, gradient, forces, fixed);
  for (std::size_t k = 0; k < equal.size(); ++k) {
    EqualPaths& own = equal[k];
    own.fractions = fractions[k];
    drop_unused_paths(loci[k], own);
    own.length = combined_length(own);
    own.across.clear();
    for (std::size_t b = 1; b < own.geodesics.size(); ++b)
      own.across.push_back(
          free_part(own.geodesics[b].gradient() - own.geodesics[0].gradient(), loci[k], fixed).normalized());
  }
  std::erase_if(loci, [](const CutLocus& locus) { return locus.sides.size() < 2; });
  state.set_cut_loci(std::move(loci));
}

}  // namespace supple::embedded
