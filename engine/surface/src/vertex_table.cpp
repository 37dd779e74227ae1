#include "vertex_table.h"

#include <algorithm>
#include <cmath>

#include "search_target.h"

namespace supple::surface {
namespace {

/// Minimum relative improvement of a vertex's distance; less is rounding.
constexpr double min_distance_improvement = 4e-16;
/// A vertex whose distance improves by this relative amount emits its windows again, because the excess length of the
/// earlier ones has to stay well below drop_tolerance.
constexpr double min_reemission_improvement = 1e-13;

}  // namespace

VertexTable::VertexTable(const SearchMesh& mesh) : mesh_(mesh) {
  distances_.resize(static_cast<std::size_t>(mesh.mesh->vertex_count()), Distance{infinity, 0});
  records_.resize(distances_.size());
}

void VertexTable::start(std::uint32_t epoch, double relative_error) {
  if (epoch == 1) {
    for (Distance& d : distances_) d.epoch = 0;
  }
  epoch_ = epoch;
  relative_error_ = relative_error;
  edge_rounding_ = edge_rounding * mesh_.longest_edge;
  ties_.clear();
  reached_count_ = 0;
}

VertexRecord& VertexTable::record(std::int32_t v) {
  VertexRecord& record = records_[v];
  if (distances_[v].epoch != epoch_) {
    distances_[v] = {infinity, epoch_};
    ++reached_count_;
    record = VertexRecord{};
    record.emits = mesh_.pins(v);
    record.emits_all_around = record.emits && relative_error_ > 0;
  }
  return record;
}

VertexTable::Improvement VertexTable::improve(std::int32_t v, double distance, double sigma, double source_x,
                                              double depth, std::int32_t halfedge, Trail trail, std::int32_t origin,
                                              std::int32_t along, double crossing, bool straight) {
  VertexRecord& record = this->record(v);
  double& current = distances_[v].value;
  const bool improves = distance < current * (1 - min_distance_improvement);
  const bool ties = distance < current * (1 + drop_tolerance) && distance > current * (1 - drop_tolerance);
  bool replaces = improves;
  if (ties && current > 0) {
    // Among paths of equal length, the one whose last segment is longest is recorded, so that a vertex on a straight
    // path does not seem to pin it.
    const bool straighter = along < 0 && straight && (record.along >= 0 || sigma < record.sigma * (1 - drop_tolerance));
    replaces = straighter || (improves && along >= 0 && record.along >= 0);
  }
  bool must_emit = false;
  if (record.emits && !record.emits_all_around && both_shortest(distance, current)) {
    const VertexRecord path{.sigma = sigma, .source_x = source_x, .depth = depth, .halfedge = halfedge, .along = along};
    must_emit = note_tie(v, path, distance, replaces);
    if (distance < current * (1 - min_reemission_improvement)) {
      record.emitted = false;
      for (std::int32_t i = record.ties; i >= 0; i = ties_[i].next) ties_[i].emitted = false;
      must_emit = true;
    }
  } else if (improves) {
    record.emitted = false;
    record.ties = -1;
    must_emit = record.emits && replaces;
  }
  if (!replaces) {
    if (improves) current = distance;
    return {false, must_emit};
  }
  current = std::min(current, distance);
  record.sigma = sigma;
  record.source_x = source_x;
  record.depth = depth;
  record.crossing = crossing;
  record.trail = trail;
  record.halfedge = halfedge;
  record.origin = origin;
  record.along = along;
  if (improves && record.emits_all_around) make_pseudo_source(v);
  return {improves, must_emit};
}

bool VertexTable::note_tie(std::int32_t v, const VertexRecord& path, double length, bool replaces) {
  VertexRecord& record = records_[v];
  const bool is_source = record.halfedge < 0 && record.along < 0;
  if (is_source) return false;
  if (path.along >= 0 ? path.along == record.along
                      : path.halfedge == record.halfedge &&
                            std::abs(path.source_x - record.source_x) + std::abs(path.depth - record.depth) <=
                                sector_tolerance * path.depth) {
    return false;
  }
  const double total = mesh_.mesh->vertex_angle(v);
  const double full_turn = mesh_.mesh->is_boundary(v) ? infinity : total;
  const auto apart = [&](double a, double b) {
    const double turn = std::abs(a - b);
    return std::min(turn, full_turn - turn) > sector_tolerance;
  };
  const double recorded = arrival_angle(mesh_, record, v);
  const double angle = arrival_angle(mesh_, path, v);
  if (!apart(angle, recorded)) return false;
  const double noted = replaces ? recorded : angle;
  bool is_noted = false;
  for (std::int32_t i = record.ties; i >= 0; i = ties_[i].next) is_noted = is_noted || !apart(ties_[i].angle, noted);
  if (!is_noted) {
    ties_.push_back({noted, replaces ? distances_[v].value : length, replaces && record.emitted, record.ties});
    record.ties = static_cast<std::int32_t>(ties_.size()) - 1;
  }
  if (replaces) record.emitted = false;
  return replaces || (!is_noted && within_drop_tolerance(length, distances_[v].value));
}

void VertexTable::make_pseudo_source(std::int32_t v) {
  VertexRecord& record = records_[v];
  const double weight = length_of_path(v) / (1 + relative_error_);
  record.emits_all_around = record.emits = true;
  record.sigma = distances_[v].value = weight;
}

}  // namespace supple::surface
