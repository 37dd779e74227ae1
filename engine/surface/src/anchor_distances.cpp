#include "anchor_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "supple/base/threads.h"

namespace supple::surface {
namespace {

/// Searches on meshes of fewer faces take too short a time for threads to pay.
constexpr std::int64_t least_faces_for_threads = 5000;

/// Of more anchors, the first positions are searched from the moving point to all at once: a pair search is seldom
/// cheaper than a twentieth of that.
constexpr std::size_t most_anchors_for_pairs = 16;

/// What a kept field is taken to cost, in windows of a pair search per face: on the benchmark's meshes
/// (docs/bench/karcher.md) it propagates 5 to 54 windows per face, 8 to 12 on most, and a window that is kept takes
/// about three times as long: its memory is touched for the first time.
constexpr double windows_per_face = 10;
constexpr double keeping_costs = 3;

/// Two paths whose lengths differ by less than this share of the mesh diagonal count as equally short.
constexpr double cut_locus_excess = 1e-9;

/// `end`: 0 if the moving point is the geodesic's first end, 1 if it is the second.
AnchorGeodesic seen_from(int end, const Geodesic& geodesic, double diagonal) {
  AnchorGeodesic seen;
  seen.distance = geodesic.distance;
  seen.certain = geodesic.unique && geodesic.competing_excess > cut_locus_excess * diagonal;
  seen.coincident = geodesic.distance == 0;
  if (geodesic.derivatives) {
    seen.gradient = geodesic.derivatives->tangent_gradient.segment<2>(2 * end);
    seen.hessian = geodesic.derivatives->tangent_hessian.block<2, 2>(2 * end, 2 * end);
  }
  const auto& path = geodesic.path;
  if (path.size() >= 2) seen.neighbour = (end == 0 ? path[1] : path[path.size() - 2]).point;
  return seen;
}

double windows_of(const CostLedger& ledger) {
  for (const auto& quantity : ledger.quantities())
    if (quantity.name == "windows") return quantity.value;
  return 0;
}

std::string rounded(double value) { return std::to_string(std::llround(value)); }

}  // namespace

AnchorSearchChoice cheapest_search(const AnchorSearchFacts& facts) {
  const double field = windows_per_face * static_cast<double>(facts.faces);
  const double evaluations = static_cast<double>(facts.evaluations);
  const double anchors = static_cast<double>(facts.anchors);
  const double by_fields = anchors * field * keeping_costs;
  const double by_one = evaluations * field;
  const double by_pairs = facts.windows_per_pair > 0 ? evaluations * anchors * facts.windows_per_pair
                                                     : std::numeric_limits<double>::infinity();

  const auto why = [&](const std::string& chosen, double cost, const std::string& other, double other_cost) {
    return "for " + rounded(anchors) + " points, about " + rounded(evaluations) + " evaluations and " +
           rounded(static_cast<double>(facts.faces)) + " faces " + chosen + " take an estimated " + rounded(cost) +
           " windows, " + other + " " + rounded(other_cost);
  };
  if (by_fields < std::min(by_one, by_pairs))
    return {AnchorSearch::fields,
            why("kept fields", by_fields, "searches for each evaluation", std::min(by_one, by_pairs))};
  if (by_pairs <= by_one) return {AnchorSearch::pairs, why("pair searches", by_pairs, "kept fields", by_fields)};
  return {AnchorSearch::one_to_many, why("one search for each evaluation", by_one, "kept fields", by_fields)};
}

AnchorDistances::AnchorDistances(const GeodesicSolver& solver, std::vector<SurfacePoint> anchors)
    : solver_(solver),
      anchors_(std::move(anchors)),
      search_(anchors_.size() <= most_anchors_for_pairs ? AnchorSearch::pairs : AnchorSearch::one_to_many) {}

double AnchorDistances::for_each(std::size_t n, const Execution& execution,
                                 const std::function<void(int, const Execution&)>& body) {
  std::vector<CostLedger> ledgers(n);
  const auto run = [&](int i) { body(i, Execution{execution.cancellation, nullptr, &ledgers[i]}); };
  const int count = static_cast<int>(n);
  if (n > 1 && solver_.mesh().face_count() >= least_faces_for_threads && thread_count() > 1)
    parallel_for(count, run);
  else
    for (int i = 0; i < count; ++i) run(i);
  // Only what was counted is merged: the caller bills the time that passes, not that of every thread.
  double windows = 0;
  for (const CostLedger& ledger : ledgers) {
    windows += windows_of(ledger);
    if (!execution.cost) continue;
    for (const auto& quantity : ledger.quantities()) execution.cost->add_quantity(quantity.name, quantity.value);
  }
  if (execution.cost) execution.cost->add_quantity("searches", static_cast<double>(n));
  return windows;
}

std::vector<std::vector<double>> AnchorDistances::between(const std::vector<std::size_t>& chosen,
                                                          const Execution& execution) {
  std::vector<std::vector<double>> rows(chosen.size(), std::vector<double>(anchors_.size(), 0.0));
  if (search_ != AnchorSearch::pairs) {
    for (std::size_t r = 0; r < chosen.size(); ++r) {
      const auto found = at(anchors_[chosen[r]], Need::values, execution);
      for (std::size_t i = 0; i < found.size(); ++i) rows[r][i] = found[i].distance;
    }
    return rows;
  }
  struct Entry {
    std::size_t row;
    std::size_t anchor;
  };
  std::vector<Entry> entries;
  const auto row_of = [&](std::size_t anchor) {
    return static_cast<std::size_t>(std::ranges::lower_bound(chosen, anchor) - chosen.begin());
  };
  for (std::size_t r = 0; r < chosen.size(); ++r) {
    for (std::size_t i = 0; i < anchors_.size(); ++i) {
      const std::size_t other = row_of(i);
      const bool known = i == chosen[r] || (other < r && chosen[other] == i);
      if (!known) entries.push_back({r, i});
    }
  }
  const StageTimer timer(execution.cost, "search");
  pair_windows_ += for_each(entries.size(), execution, [&](int k, const Execution& own) {
    const Entry& entry = entries[k];
    rows[entry.row][entry.anchor] = solver_.distance(anchors_[chosen[entry.row]], anchors_[entry.anchor], own);
  });
  pairs_searched_ += static_cast<std::int64_t>(entries.size());
  for (std::size_t r = 0; r < chosen.size(); ++r)
    for (std::size_t other = 0; other < r; ++other) rows[r][chosen[other]] = rows[other][chosen[r]];
  return rows;
}

AnchorSearchFacts AnchorDistances::facts(std::int64_t evaluations) const {
  AnchorSearchFacts facts;
  facts.faces = solver_.mesh().face_count();
  facts.anchors = static_cast<std::int64_t>(anchors_.size());
  facts.evaluations = evaluations;
  if (pairs_searched_ > 0) facts.windows_per_pair = std::max(1.0, pair_windows_ / static_cast<double>(pairs_searched_));
  return facts;
}

void AnchorDistances::use(AnchorSearch search, const Execution& execution) {
  search_ = search;
  if (search_ != AnchorSearch::fields) return;
  FieldOptions options;
  options.keep_windows = true;
  const StageTimer timer(execution.cost, "search");
  fields_.assign(anchors_.size(), GeodesicField(nullptr));
  for_each(anchors_.size(), execution,
           [&](int i, const Execution& own) { fields_[i] = solver_.field(std::span(&anchors_[i], 1), options, own); });
}

std::vector<AnchorGeodesic> AnchorDistances::at(const SurfacePoint& p, Need need, const Execution& execution) {
  GeodesicOptions options;
  options.derivatives = need == Need::derivatives ? 2 : 0;
  options.path = need == Need::directions;
  const StageTimer timer(execution.cost, "search");
  const double diagonal = solver_.mesh().diagonal();

  std::vector<AnchorGeodesic> seen(anchors_.size());
  switch (search_) {
    case AnchorSearch::one_to_many:
      for_each(1, execution, [&](int, const Execution& own) {
        const std::vector<Geodesic> found = solver_.geodesics(p, anchors_, options, own);
        for (std::size_t i = 0; i < found.size(); ++i) seen[i] = seen_from(0, found[i], diagonal);
      });
      break;
    case AnchorSearch::pairs:
      pair_windows_ += for_each(anchors_.size(), execution, [&](int i, const Execution& own) {
        seen[i] = seen_from(1, solver_.geodesic(anchors_[i], p, options, own), diagonal);
      });
      pairs_searched_ += static_cast<std::int64_t>(anchors_.size());
      break;
    case AnchorSearch::fields:
      for (std::size_t i = 0; i < fields_.size(); ++i)
        seen[i] = seen_from(1, fields_[i].geodesic(p, options), diagonal);
      break;
  }
  return seen;
}

}  // namespace supple::surface
