#include "cut_locus_crossings.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "cut_loci.h"

namespace supple::embedded {
namespace {

using Candidate = numerics::NonsmoothCandidate<NetworkState>;
using surface::TangentGeodesic;

constexpr std::size_t max_cut_locus_candidates = 4;
/// Paths are the same where their gradients differ by less than this.
constexpr double same_path_gradient = 1e-4;
/// Bisections of a step to find where it crossed a cut locus.
constexpr int cut_locus_bisections = 50;
/// Relative difference of lengths above which a path is shorter than another one, and not by rounding.
constexpr double length_rounding = 1e-10;

/// A cut locus that a step crossed.
struct Crossing {
  double excess;    ///< energy by which the step exceeds the prediction
  double fraction;  ///< fraction of the step up to the cut locus
  CutLocus locus;   ///< at the crossing, in the coordinates before the step
};

/// All known shortest paths between the ends of a path.
std::vector<TangentGeodesic> shortest_paths(const FoundPaths& found, std::size_t path) {
  if (const EqualPaths* equal = found.equal_to(path)) return equal->geodesics;
  return {found.geodesics[path]};
}

/// Equally short paths before a step, and the different path that is shortest after it, as functions of the fraction of
/// the step.
class PathChange {
 public:
  PathChange(const std::vector<TangentGeodesic>& before, TangentGeodesic after, const Eigen::Vector4d& step)
      : before_(before), after_(std::move(after)), step_(step) {}

  bool is_same_path() const {
    const Eigen::Vector4d gradient = after_.extrapolated(-step_).gradient();
    return std::ranges::any_of(
        before_, [&](const auto& one) { return (one.gradient() - gradient).norm() < same_path_gradient; });
  }
  /// How much longer the paths before the step are than the other one at a fraction of the step. The paths before are
  /// equally long; where one of them is left, it becomes longer than the others, so the longest counts.
  double excess(double fraction) const {
    double longest = 0;
    for (const TangentGeodesic& one : before_) longest = std::max(longest, one.extrapolated(fraction * step_).distance);
    return longest - after_.extrapolated((fraction - 1) * step_).distance;
  }
  bool is_longer(double fraction) const { return excess(fraction) > length_rounding * after_.distance; }
  bool is_equal(double fraction) const { return std::abs(excess(fraction)) <= length_rounding * after_.distance; }
  /// The fraction of the step at which all paths are equally long; the excess is negative at its start.
  double crossing() const {
    double low = 0;
    double high = 1;
    for (int k = 0; k < cut_locus_bisections; ++k) {
      const double middle = 0.5 * (low + high);
      (excess(middle) < 0 ? low : high) = middle;
    }
    return high;
  }
  std::vector<TangentGeodesic> paths_at(double fraction) const {
    std::vector<TangentGeodesic> equal;
    equal.reserve(before_.size() + 1);
    for (const TangentGeodesic& one : before_) equal.push_back(one.extrapolated(fraction * step_));
    equal.push_back(after_.extrapolated((fraction - 1) * step_));
    return equal;
  }

 private:
  const std::vector<TangentGeodesic>& before_;
  TangentGeodesic after_;
  Eigen::Vector4d step_;
};

/// The first cut locus at which another path becomes shorter than this one, which is under compression, on the step
/// from one state to the next; nothing where none does.
std::optional<Crossing> first_crossing(const ElasticNetwork& network, std::size_t path, double force,
                                       const NetworkState& current, const NetworkState& next) {
  if (current.found()->geodesics[path].coincident() || next.found()->geodesics[path].coincident()) return std::nullopt;
  const auto [from, to] = network.paths()[path];
  Eigen::Vector4d step;
  step << next.last_step().segment<2>(2 * from), next.last_step().segment<2>(2 * to);
  const std::vector<TangentGeodesic> before = shortest_paths(*current.found(), path);
  std::optional<Crossing> first;
  for (const TangentGeodesic& after : shortest_paths(*next.found(), path)) {
    const PathChange change(
        before,
        after.in_frames_before(next.turn(static_cast<std::size_t>(from)), next.turn(static_cast<std::size_t>(to))),
        step);
    if (change.is_same_path() || !change.is_longer(1)) continue;
    const bool is_in_place = change.is_equal(0);
    if (!is_in_place && !(change.excess(0) < 0)) continue;
    const double fraction = is_in_place ? 0 : change.crossing();
    if (first && first->fraction <= fraction) continue;
    CutLocus locus{path, from, to};
    locus.for_next_step = is_in_place;
    locus.sides = sides_of(change.paths_at(fraction), locus, network.fixed());
    if (!locus.sides.empty()) first = Crossing{-force * change.excess(1), fraction, std::move(locus)};
  }
  return first;
}

struct CrossedStep {
  Crossing crossing;
  Eigen::VectorXd step;
};

/// For each path the first cut locus on the shortest step that crosses one, in the order of falling excess.
std::vector<CrossedStep> crossings(const ElasticNetwork& network, const NetworkState& current,
                                   const std::vector<NetworkState>& trials) {
  std::vector<CrossedStep> found;
  const std::vector<double> forces = network.path_forces(*current.found());
  for (std::size_t i = 0; i < network.paths().size(); ++i) {
    const auto [from, to] = network.paths()[i];
    const auto a = static_cast<std::size_t>(from);
    const auto b = static_cast<std::size_t>(to);
    const bool is_fixed = network.is_fixed(from) && network.is_fixed(to);
    if (!(forces[i] < 0) || is_fixed || current.on_tip(a) || current.on_tip(b)) continue;
    // A step is shortened from trial to trial, so the last one is the shortest.
    for (auto trial = trials.rbegin(); trial != trials.rend(); ++trial) {
      if (!trial->found() || trial->on_tip(a) || trial->on_tip(b)) continue;
      auto crossing = first_crossing(network, i, forces[i], current, *trial);
      if (!crossing) continue;
      found.push_back({std::move(*crossing), trial->last_step()});
      break;
    }
  }
  std::ranges::stable_sort(found, std::ranges::greater(), [](const CrossedStep& one) { return one.crossing.excess; });
  return found;
}

void keep_at(NetworkState& state, const CutLocus& locus) {
  std::vector<CutLocus> loci = state.cut_loci();
  std::erase_if(loci, [&](const CutLocus& other) { return other.path == locus.path; });
  loci.insert(std::ranges::upper_bound(loci, locus.path, {}, &CutLocus::path), locus);
  state.set_cut_loci(std::move(loci));
}

}  // namespace

std::vector<Candidate> cut_locus_candidates(const ElasticNetwork& network, const NetworkState& current,
                                            const std::vector<NetworkState>& trials) {
  if (current.surface() || !current.found() || !current.found()->mollified.empty()) return {};
  std::vector<Candidate> candidates;
  std::optional<Candidate> in_place;
  for (const auto& [crossing, step] : crossings(network, current, trials)) {
    if (crossing.locus.for_next_step) {
      if (!in_place) {
        in_place = Candidate{current, -1 - static_cast<std::int64_t>(network.paths().size()), 0, true};
        in_place->state.move(Eigen::VectorXd::Zero(current.dimension()));
      }
      keep_at(in_place->state, crossing.locus);
    } else if (candidates.size() < max_cut_locus_candidates) {
      const Eigen::VectorXd to_locus = crossing.fraction * step;
      const auto id = -1 - static_cast<std::int64_t>(crossing.locus.path);
      Candidate& candidate = candidates.emplace_back(Candidate{current, id, to_locus.norm(), false});
      keep_at(candidate.state, crossing.locus);
      candidate.state.move(to_locus);
    }
  }
  if (in_place) candidates.push_back(std::move(*in_place));
  return candidates;
}

}  // namespace supple::embedded
