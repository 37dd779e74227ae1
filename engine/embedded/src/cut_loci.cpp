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

/// Lengths in mean edges: paths to the sides of a cut locus are first looked for so far from it, where they are told
/// apart from rounding, then ten times as far, up to the farthest.
constexpr std::array side_distances{1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1};
/// Two paths are the same where their gradients differ by less than this, and by less than `bend` times the way to
/// where they were found over their length, which is what crossing other edges may change.
constexpr double same_gradient = 1e-6;
constexpr double bend = 1;
/// Lengths that differ by less than this share are equal but for rounding.
constexpr double equal_lengths = 1e-14;
/// A path whose lengths still differ by more than this share after the last adjustment is not kept.
constexpr double almost_equal = 1e-11;
constexpr int max_adjustments = 12;

Vector4d free_part(const Vector4d& change, const CutLocus& locus, const std::vector<bool>& held) {
  Vector4d part = change;
  if (held[static_cast<std::size_t>(locus.from)]) part.head<2>().setZero();
  if (held[static_cast<std::size_t>(locus.to)]) part.tail<2>().setZero();
  return part;
}

/// The shortest path between ends that have moved by `offset`, continued to where they are.
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
  return found.before_turns(from.turn, to.turn).continued(-offset);
}

bool are_different(const std::vector<TangentGeodesic>& paths, double way) {
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if ((paths[i].gradient() - paths[j].gradient()).norm() < same_gradient + bend * way / paths[i].distance)
        return false;
  return true;
}

/// One path for each side, all different; none where these are not found.
std::vector<TangentGeodesic> paths_beside(const CutLocusContext& context, const NetworkState& state,
                                          const CutLocus& locus) {
  const double edge = context.solver.mesh().mean_edge_length();
  for (const double way : side_distances) {
    std::vector<TangentGeodesic> paths;
    for (const Vector4d& side : locus.sides) {
      const auto path = shortest_beside(context, state, locus, way * edge * side);
      if (!path) return {};
      paths.push_back(*path);
    }
    if (are_different(paths, way * edge)) return paths;
  }
  return {};
}

/// The conditions that lengths are equal, one for each path after the first of each cut locus.
struct Conditions {
  Eigen::VectorXd excess;
  Eigen::MatrixXd slopes;  ///< by all coordinates of points that belong to a path
  std::vector<std::int32_t> points;
  double shortest = 0;  ///< length of a path

  Eigen::Index row_of(std::int32_t point) const { return 2 * (std::ranges::find(points, point) - points.begin()); }
};

Conditions conditions_of(const std::vector<CutLocus>& loci, const std::vector<EqualPaths>& equal,
                         const std::vector<bool>& held) {
  Conditions conditions;
  Eigen::Index count = 0;
  conditions.shortest = equal.front().geodesics.front().distance;
  for (std::size_t k = 0; k < loci.size(); ++k) {
    conditions.shortest = std::min(conditions.shortest, equal[k].geodesics.front().distance);
    for (const std::int32_t point : {loci[k].from, loci[k].to})
      if (std::ranges::find(conditions.points, point) == conditions.points.end()) conditions.points.push_back(point);
    count += static_cast<Eigen::Index>(equal[k].geodesics.size()) - 1;
  }
  conditions.excess.resize(count);
  conditions.slopes.setZero(count, 2 * static_cast<Eigen::Index>(conditions.points.size()));
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < loci.size(); ++k) {
    const auto& paths = equal[k].geodesics;
    for (std::size_t b = 1; b < paths.size(); ++b, ++row) {
      conditions.excess[row] = paths[b].distance - paths[0].distance;
      const Vector4d slope = free_part(paths[b].gradient() - paths[0].gradient(), loci[k], held);
      conditions.slopes.block<1, 2>(row, conditions.row_of(loci[k].from)) += slope.head<2>().transpose();
      conditions.slopes.block<1, 2>(row, conditions.row_of(loci[k].to)) += slope.tail<2>().transpose();
    }
  }
  return conditions;
}

/// The shortest paths at all cut loci where the points are; those without are forgotten.
std::vector<EqualPaths> paths_at(const CutLocusContext& context, NetworkState& state) {
  std::vector<CutLocus> kept;
  std::vector<EqualPaths> equal;
  for (const CutLocus& locus : state.cut_loci()) {
    EqualPaths own{.path = locus.path, .geodesics = paths_beside(context, state, locus)};
    if (own.geodesics.empty()) continue;
    CutLocus turned = locus;
    turned.sides = sides_of(own.geodesics, locus, context.held);
    if (turned.sides.empty()) continue;
    kept.push_back(std::move(turned));
    equal.push_back(std::move(own));
  }
  state.set_cut_loci(std::move(kept));
  return equal;
}

}  // namespace

std::vector<Vector4d> sides_of(const std::vector<TangentGeodesic>& paths, const CutLocus& locus,
                               const std::vector<bool>& held) {
  std::vector<Vector4d> sides;
  for (const TangentGeodesic& own : paths) {
    Vector4d side = Vector4d::Zero();
    for (const TangentGeodesic& other : paths) {
      if (&other == &own) continue;
      const Vector4d away = free_part(other.gradient() - own.gradient(), locus, held);
      if (away.norm() < same_gradient) return {};
      side += away.normalized();
    }
    if (side.norm() < same_gradient) return {};
    sides.push_back(side.normalized());
  }
  return sides;
}

std::vector<EqualPaths> keep_at_cut_loci(const CutLocusContext& context, NetworkState& state) {
  for (int adjustment = 0;; ++adjustment) {
    std::vector<EqualPaths> equal = paths_at(context, state);
    if (equal.empty()) return {};
    const Conditions conditions = conditions_of(state.cut_loci(), equal, context.held);
    if (conditions.excess.size() == 0) return equal;
    const double worst = conditions.excess.cwiseAbs().maxCoeff();
    const bool last = adjustment == max_adjustments;
    if (worst <= (last ? almost_equal : equal_lengths) * conditions.shortest) return equal;
    if (last) {
      state.set_cut_loci({});
      return {};
    }
    const Eigen::VectorXd way = -conditions.slopes.completeOrthogonalDecomposition().solve(conditions.excess);
    // Paths whose lengths hardly change would be equal far away, if at all.
    if (!(way.norm() <= conditions.shortest)) {
      state.set_cut_loci({});
      return {};
    }
    Eigen::VectorXd step = Eigen::VectorXd::Zero(state.dimension());
    for (const std::int32_t point : conditions.points)
      step.segment<2>(2 * point) = way.segment<2>(conditions.row_of(point));
    state.adjust(step);
  }
}

namespace {

template <class Chosen>
void let_go_of(NetworkState& state, std::vector<EqualPaths>& equal, const Chosen& chosen) {
  std::vector<CutLocus> loci = state.cut_loci();
  std::erase_if(
      loci, [&](const CutLocus& locus) { return chosen(*std::ranges::find(equal, locus.path, &EqualPaths::path)); });
  std::erase_if(equal, chosen);
  state.set_cut_loci(std::move(loci));
}

}  // namespace

void let_go_of_longer(NetworkState& state, std::vector<EqualPaths>& equal,
                      const std::vector<TangentGeodesic>& shortest) {
  let_go_of(state, equal, [&](const EqualPaths& own) {
    const double least = shortest[own.path].distance;
    return std::abs(own.geodesics.front().distance - least) > almost_equal * least;
  });
}

void let_go_of_pulling(NetworkState& state, std::vector<EqualPaths>& equal, const std::vector<double>& pulls) {
  let_go_of(state, equal, [&](const EqualPaths& own) { return !(pulls[own.path] < 0); });
}

namespace {

/// The least sum of a vector and of convex combinations, one of each set of columns.
class LeastSum {
 public:
  LeastSum(Eigen::VectorXd fixed, std::vector<Eigen::MatrixXd> sets) : sum_(std::move(fixed)), sets_(std::move(sets)) {
    for (const Eigen::MatrixXd& set : sets_) {
      shares_.push_back(Eigen::VectorXd::Unit(set.cols(), 0));
      sum_ += set.col(0);
    }
  }

  std::vector<Eigen::VectorXd> shares() {
    for (int sweep = 0; sweep < max_sweeps && exchange_all() > smallest_exchange; ++sweep) continue;
    if (const auto exact = on_support()) return *exact;
    return shares_;
  }

 private:
  static constexpr int max_sweeps = 500;
  static constexpr double smallest_exchange = 1e-10;

  /// Moves shares between any two columns of a set, as much as is best. Returns the largest that was moved.
  double exchange_all() {
    double largest = 0;
    for (std::size_t k = 0; k < sets_.size(); ++k)
      for (Eigen::Index i = 0; i < sets_[k].cols(); ++i)
        for (Eigen::Index j = 0; j < i; ++j) {
          const Eigen::VectorXd way = sets_[k].col(i) - sets_[k].col(j);
          const double length = way.squaredNorm();
          if (!(length > 0)) continue;
          const double moved = std::clamp(-way.dot(sum_) / length, -shares_[k][i], shares_[k][j]);
          shares_[k][i] += moved;
          shares_[k][j] -= moved;
          sum_ += moved * way;
          largest = std::max(largest, std::abs(moved));
        }
    return largest;
  }

  /// The same to rounding, for the columns that have shares; none where others would have some.
  std::optional<std::vector<Eigen::VectorXd>> on_support() const {
    std::vector<std::pair<std::size_t, Eigen::Index>> free;
    std::vector<Eigen::Index> first(sets_.size());
    for (std::size_t k = 0; k < sets_.size(); ++k) {
      shares_[k].maxCoeff(&first[k]);
      for (Eigen::Index i = 0; i < sets_[k].cols(); ++i)
        if (i != first[k] && shares_[k][i] > smallest_exchange) free.emplace_back(k, i);
    }
    std::vector<Eigen::VectorXd> exact(sets_.size());
    for (std::size_t k = 0; k < sets_.size(); ++k) exact[k] = Eigen::VectorXd::Unit(sets_[k].cols(), first[k]);
    if (free.empty()) return exact;
    Eigen::VectorXd fixed = sum_;
    for (std::size_t k = 0; k < sets_.size(); ++k) fixed += sets_[k] * (exact[k] - shares_[k]);
    Eigen::MatrixXd ways(sum_.size(), static_cast<Eigen::Index>(free.size()));
    for (Eigen::Index c = 0; c < ways.cols(); ++c) {
      const auto& [k, i] = free[static_cast<std::size_t>(c)];
      ways.col(c) = sets_[k].col(i) - sets_[k].col(first[k]);
    }
    const Eigen::VectorXd found = -ways.completeOrthogonalDecomposition().solve(fixed);
    for (Eigen::Index c = 0; c < ways.cols(); ++c) {
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
  std::vector<Eigen::VectorXd> shares_;
};

/// The shares with which the force that is left is the least.
std::vector<Eigen::VectorXd> shares_of(const std::vector<CutLocus>& loci, const std::vector<EqualPaths>& equal,
                                       const Eigen::VectorXd& gradient, const std::vector<double>& pulls,
                                       const std::vector<bool>& held) {
  const Conditions conditions = conditions_of(loci, equal, held);
  Eigen::VectorXd fixed = Eigen::VectorXd::Zero(conditions.slopes.cols());
  for (const std::int32_t point : conditions.points)
    if (!held[static_cast<std::size_t>(point)])
      fixed.segment<2>(conditions.row_of(point)) = gradient.segment<2>(2 * point);
  std::vector<Eigen::MatrixXd> sets;
  for (std::size_t k = 0; k < equal.size(); ++k) {
    Eigen::MatrixXd set = Eigen::MatrixXd::Zero(fixed.size(), static_cast<Eigen::Index>(equal[k].geodesics.size()));
    for (Eigen::Index b = 0; b < set.cols(); ++b) {
      const Vector4d force =
          pulls[equal[k].path] * free_part(equal[k].geodesics[static_cast<std::size_t>(b)].gradient(), loci[k], held);
      set.block<2, 1>(conditions.row_of(loci[k].from), b) = force.head<2>();
      set.block<2, 1>(conditions.row_of(loci[k].to), b) = force.tail<2>();
    }
    fixed -= set.col(0);
    sets.push_back(std::move(set));
  }
  return LeastSum(std::move(fixed), std::move(sets)).shares();
}

/// Forgets the paths that have no share.
void let_go(CutLocus& locus, EqualPaths& equal) {
  Eigen::Index kept = 0;
  for (Eigen::Index b = 0; b < equal.shares.size(); ++b) {
    if (!(equal.shares[b] > 0) && !locus.for_next_step) continue;
    const auto to = static_cast<std::size_t>(kept);
    const auto from = static_cast<std::size_t>(b);
    locus.sides[to] = locus.sides[from];
    equal.geodesics[to] = equal.geodesics[from];
    equal.shares[kept++] = equal.shares[b];
  }
  locus.for_next_step = false;
  locus.sides.resize(static_cast<std::size_t>(kept));
  equal.geodesics.resize(static_cast<std::size_t>(kept));
  equal.shares.conservativeResize(kept);
}

LengthDerivatives shared_length(const EqualPaths& equal) {
  LengthDerivatives result;
  result.length = std::ranges::min_element(equal.geodesics, {}, &TangentGeodesic::distance)->distance;
  for (std::size_t b = 0; b < equal.geodesics.size(); ++b) {
    const double share = equal.shares[static_cast<Eigen::Index>(b)];
    result.gradient += share * equal.geodesics[b].gradient();
    result.hessian += share * equal.geodesics[b].hessian();
  }
  return result;
}

}  // namespace

void share_forces(NetworkState& state, std::vector<EqualPaths>& equal, const Eigen::VectorXd& gradient,
                  const std::vector<double>& pulls, const std::vector<bool>& held) {
  std::vector<CutLocus> loci = state.cut_loci();
  const std::vector<Eigen::VectorXd> shares = shares_of(loci, equal, gradient, pulls, held);
  for (std::size_t k = 0; k < equal.size(); ++k) {
    EqualPaths& own = equal[k];
    own.shares = shares[k];
    let_go(loci[k], own);
    own.length = shared_length(own);
    own.across.clear();
    for (std::size_t b = 1; b < own.geodesics.size(); ++b)
      own.across.push_back(
          free_part(own.geodesics[b].gradient() - own.geodesics[0].gradient(), loci[k], held).normalized());
  }
  std::erase_if(loci, [](const CutLocus& locus) { return locus.sides.size() < 2; });
  state.set_cut_loci(std::move(loci));
}

}  // namespace supple::embedded
