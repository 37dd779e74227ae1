#include "anchor_distances.h"

#include <cmath>
#include <functional>
#include <span>
#include <utility>

#include "supple/base/threads.h"

namespace supple::surface {
namespace {

/// Searches on meshes of fewer faces take too short a time for threads to pay.
constexpr std::int64_t least_faces_for_threads = 5000;

/// Two paths whose lengths differ by less than this share of the mesh diagonal count as equally short.
constexpr double cut_locus_excess = 1e-9;

/// Runs body(i, execution) for i in [0, n), in parallel where the mesh is large enough, and merges what the bodies
/// count. Their times stay out: the caller bills the time that passes.
void for_each_anchor(const GeodesicSolver& solver, std::size_t n, const Execution& execution,
                     const std::function<void(int, const Execution&)>& body) {
  std::vector<CostLedger> ledgers(execution.cost ? n : 0);
  const auto run = [&](int i) {
    body(i, Execution{execution.cancellation, nullptr, ledgers.empty() ? nullptr : &ledgers[i]});
  };
  const int count = static_cast<int>(n);
  if (n > 1 && solver.mesh().face_count() >= least_faces_for_threads && thread_count() > 1)
    parallel_for(count, run);
  else
    for (int i = 0; i < count; ++i) run(i);
  for (const CostLedger& ledger : ledgers)
    for (const auto& quantity : ledger.quantities()) execution.cost->add_quantity(quantity.name, quantity.value);
}

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

}  // namespace

AnchorSearchChoice cheapest_search(std::int64_t faces, std::int64_t anchors, std::int64_t evaluations) {
  (void)faces;
  (void)evaluations;
  if (anchors >= 24) return {AnchorSearch::one_to_many, ""};
  return {AnchorSearch::pairs, ""};
}

AnchorDistances::AnchorDistances(const GeodesicSolver& solver, std::vector<SurfacePoint> anchors, AnchorSearch search,
                                 const Execution& execution)
    : solver_(solver), anchors_(std::move(anchors)), search_(search) {
  if (search_ != AnchorSearch::fields) return;
  FieldOptions options;
  options.keep_windows = true;
  fields_.assign(anchors_.size(), GeodesicField(nullptr));
  const StageTimer timer(execution.cost, "search");
  for_each_anchor(solver_, anchors_.size(), execution, [&](int i, const Execution& own) {
    fields_[i] = solver_.field(std::span(&anchors_[i], 1), options, own);
  });
}

std::vector<AnchorGeodesic> AnchorDistances::at(const SurfacePoint& p, Need need, const Execution& execution) const {
  GeodesicOptions options;
  options.derivatives = need == Need::derivatives ? 2 : 0;
  options.path = need == Need::directions;
  const StageTimer timer(execution.cost, "search");
  const double diagonal = solver_.mesh().diagonal();

  std::vector<AnchorGeodesic> seen(anchors_.size());
  switch (search_) {
    case AnchorSearch::one_to_many: {
      CostLedger ledger;
      const Execution own{execution.cancellation, nullptr, execution.cost ? &ledger : nullptr};
      const std::vector<Geodesic> found = solver_.geodesics(p, anchors_, options, own);
      for (std::size_t i = 0; i < found.size(); ++i) seen[i] = seen_from(0, found[i], diagonal);
      for (const auto& quantity : ledger.quantities()) execution.cost->add_quantity(quantity.name, quantity.value);
      break;
    }
    case AnchorSearch::pairs:
      for_each_anchor(solver_, anchors_.size(), execution, [&](int i, const Execution& own) {
        seen[i] = seen_from(1, solver_.geodesic(anchors_[i], p, options, own), diagonal);
      });
      break;
    case AnchorSearch::fields:
      for (std::size_t i = 0; i < fields_.size(); ++i)
        seen[i] = seen_from(1, fields_[i].geodesic(p, options), diagonal);
      break;
  }
  return seen;
}

}  // namespace supple::surface
