#include "anchor_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "supple/base/threads.h"

namespace supple::surface {
namespace {

/// Minimum number of faces for parallel searches. On smaller meshes they are too short for threads to pay.
constexpr std::int64_t min_faces_for_threads = 5000;

/// Maximum number of anchors for which the first positions are evaluated by pair searches. For more anchors one search
/// from the moving point to all is cheaper, because a pair search seldom costs less than a twentieth of it.
constexpr std::size_t max_anchors_for_pairs = 16;

/// Estimated cost of a field. Windows per face grow like the square root of the number of faces, as fronts get longer
/// (docs/bench/geodesics.md: 8 on 1,280 faces, 26 on 20,480). A window that is stored for queries takes about twice as
/// long, because it is written to memory.
constexpr double windows_per_root_face = 0.2;
constexpr double storing_cost_factor = 2;

/// A pair search is expensive if it propagates more windows per face than this. It then covers a large part of the
/// surface, because straight distances are much shorter than geodesic ones.
constexpr double expensive_windows_per_face = 5;
/// Estimated number of fields that guided searches need until the moving point has converged.
constexpr double expected_landmarks = 2;
/// Maximum distance of the landmark from the moving point, as a fraction of the mean distance of the anchors. Beyond it
/// the landmark guides searches badly, and a new field is computed.
constexpr double max_landmark_fraction = 0.1;

/// Two paths whose lengths differ by less than this fraction of the mesh diagonal count as equally short.
constexpr double cut_locus_excess = 1e-9;

/// The geodesic with the moving point at its first end (`end` 0) or at its second end (`end` 1).
AnchorGeodesic anchor_geodesic(int end, const Geodesic& geodesic, double diagonal) {
  AnchorGeodesic result;
  result.distance = geodesic.distance;
  result.certain = geodesic.unique && geodesic.competing_excess > cut_locus_excess * diagonal;
  result.coincident = geodesic.distance == 0;
  if (geodesic.derivatives) {
    result.gradient = geodesic.derivatives->tangent_gradient.segment<2>(2 * end);
    result.hessian = geodesic.derivatives->tangent_hessian.block<2, 2>(2 * end, 2 * end);
  }
  const auto& path = geodesic.path;
  if (path.size() >= 2) result.neighbour = (end == 0 ? path[1] : path[path.size() - 2]).point;
  return result;
}

double windows_of(const CostLedger& ledger) {
  for (const auto& quantity : ledger.quantities())
    if (quantity.name == "windows") return quantity.value;
  return 0;
}

std::string rounded(double value) { return std::to_string(std::llround(value)); }

}  // namespace

AnchorSearchChoice cheapest_search(const AnchorSearchFacts& facts) {
  const double faces = static_cast<double>(facts.faces);
  const double windows_per_face = windows_per_root_face * std::sqrt(faces);
  const double field = windows_per_face * faces;
  const double evaluations = static_cast<double>(facts.evaluations);
  const double anchors = static_cast<double>(facts.anchors);
  const double by_fields = anchors * field * storing_cost_factor;
  const double by_one = evaluations * field;
  const double by_pairs = facts.windows_per_pair > 0 ? evaluations * anchors * facts.windows_per_pair
                                                     : std::numeric_limits<double>::infinity();

  // A guided search covers a strip around the path, whose length in faces grows like the square root of their number.
  const double by_guidance = expected_landmarks * field + evaluations * anchors * windows_per_face * std::sqrt(faces);

  const auto why = [&](const std::string& chosen, double cost, const std::string& other, double other_cost) {
    return "for " + rounded(anchors) + " points, about " + rounded(evaluations) + " evaluations and " + rounded(faces) +
           " faces " + chosen + " take an estimated " + rounded(cost) + " windows, " + other + " " +
           rounded(other_cost);
  };
  // Guided searches are chosen only if pair searches are known to be expensive, since their estimate is rough.
  const bool is_expensive = facts.windows_per_pair > expensive_windows_per_face * faces;
  if (is_expensive && by_guidance < std::min({by_fields, by_one, by_pairs}))
    return {AnchorSearch::guided,
            why("pair searches guided by a field from near the mean", by_guidance, "kept fields", by_fields)};
  if (by_fields < std::min(by_one, by_pairs))
    return {AnchorSearch::fields,
            why("kept fields", by_fields, "searches for each evaluation", std::min(by_one, by_pairs))};
  if (by_pairs <= by_one) return {AnchorSearch::pairs, why("pair searches", by_pairs, "kept fields", by_fields)};
  return {AnchorSearch::one_to_many, why("one search for each evaluation", by_one, "kept fields", by_fields)};
}

AnchorDistances::AnchorDistances(const GeodesicSolver& solver, std::vector<SurfacePoint> anchors)
    : solver_(solver),
      anchors_(std::move(anchors)),
      search_(anchors_.size() <= max_anchors_for_pairs ? AnchorSearch::pairs : AnchorSearch::one_to_many) {}

double AnchorDistances::for_each(std::size_t n, const Execution& execution,
                                 const std::function<void(int, const Execution&)>& body) {
  std::vector<CostLedger> ledgers(n);
  const auto run = [&](int i) { body(i, Execution{execution.cancellation, nullptr, &ledgers[i]}); };
  const int count = static_cast<int>(n);
  if (n > 1 && solver_.mesh().face_count() >= min_faces_for_threads && thread_count() > 1)
    parallel_for(count, run);
  else
    for (int i = 0; i < count; ++i) run(i);
  // Only counts are merged, and no times: the caller bills the time that passes, and not that of every thread.
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
  const auto search = [&](const Entry& entry, const Execution& own) {
    rows[entry.row][entry.anchor] = solver_.distance(anchors_[chosen[entry.row]], anchors_[entry.anchor], own);
  };
  if (entries.empty()) return rows;
  pair_windows_ += for_each(1, execution, [&](int, const Execution& own) { search(entries.front(), own); });
  if (pair_windows_ > expensive_windows_per_face * solver_.mesh().face_count()) {
    pairs_searched_ += 1;
    return edge_path_rows(chosen, execution);
  }
  pair_windows_ += for_each(entries.size() - 1, execution, [&](int k, const Execution& own) {
    search(entries[static_cast<std::size_t>(k) + 1], own);
  });
  pairs_searched_ += static_cast<std::int64_t>(entries.size());
  for (std::size_t r = 0; r < chosen.size(); ++r)
    for (std::size_t other = 0; other < r; ++other) rows[r][chosen[other]] = rows[other][chosen[r]];
  return rows;
}

std::vector<std::vector<double>> AnchorDistances::edge_path_rows(const std::vector<std::size_t>& chosen,
                                                                 const Execution& execution) {
  std::vector<std::vector<double>> rows(chosen.size(), std::vector<double>(anchors_.size(), 0.0));
  const TriangleMesh& mesh = solver_.mesh();
  FieldOptions options;
  options.method = FieldMethod::edge_graph;
  for_each(chosen.size(), execution, [&](int r, const Execution& own) {
    const GeodesicField field = solver_.field(std::span(&anchors_[chosen[r]], 1), options, own);
    for (std::size_t i = 0; i < anchors_.size(); ++i) {
      if (i == chosen[r]) continue;
      const Eigen::Vector3d place = position(mesh, anchors_[i]);
      double& min_distance = rows[r][i] = std::numeric_limits<double>::infinity();
      for (const std::int32_t v : mesh.faces()[index(anchors_[i].face)]) {
        min_distance = std::min(min_distance, field.vertex_distances()[v] + (mesh.positions()[v] - place).norm());
      }
    }
  });
  return rows;
}

double AnchorDistances::landmark_near(const SurfacePoint& p, const Execution& execution) {
  double landmark_distance = landmark_ ? solver_.distance(landmark_->at, p, execution) : 0;
  if (!landmark_ || landmark_distance > max_landmark_fraction * mean_distance_) {
    landmark_ = Landmark{p, solver_.field(std::span(&p, 1), {}, execution)};
    landmark_distance = 0;
  }
  return landmark_distance;
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

  std::vector<AnchorGeodesic> results(anchors_.size());
  switch (search_) {
    case AnchorSearch::one_to_many:
      for_each(1, execution, [&](int, const Execution& own) {
        const std::vector<Geodesic> found = solver_.geodesics(p, anchors_, options, own);
        for (std::size_t i = 0; i < found.size(); ++i) results[i] = anchor_geodesic(0, found[i], diagonal);
      });
      break;
    case AnchorSearch::pairs:
      pair_windows_ += for_each(anchors_.size(), execution, [&](int i, const Execution& own) {
        results[i] = anchor_geodesic(1, solver_.geodesic(anchors_[i], p, options, own), diagonal);
      });
      pairs_searched_ += static_cast<std::int64_t>(anchors_.size());
      break;
    case AnchorSearch::guided: {
      const Execution quiet{execution.cancellation, nullptr, nullptr};
      const double landmark_distance = landmark_near(p, quiet);
      for_each(anchors_.size(), execution, [&](int i, const Execution& own) {
        const PairHints hints{nullptr, &landmark_->field, landmark_distance};
        results[i] = anchor_geodesic(1, solver_.geodesic(anchors_[i], p, options, own, hints), diagonal);
      });
      mean_distance_ = 0;
      for (const AnchorGeodesic& geodesic : results)
        mean_distance_ += geodesic.distance / static_cast<double>(results.size());
      break;
    }
    case AnchorSearch::fields:
      for (std::size_t i = 0; i < fields_.size(); ++i)
        results[i] = anchor_geodesic(1, fields_[i].geodesic(p, options), diagonal);
      break;
  }
  return results;
}

}  // namespace supple::surface
