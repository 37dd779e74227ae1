#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "border_accuracy.h"
#include "border_tracer.h"

namespace supple::voronoi {

/// A place at which the border bends or is drawn, and its distance from both sites.
struct BorderBend {
  Eigen::Vector2d place;
  double distance = 0;
};

/// The bends of a border in order along it, and the pseudo-sources of the parts between them.
struct BorderBends {
  std::vector<BorderBend> bends;
  std::vector<PseudoSources> sources_of_parts;  ///< one more than bends; empty if not known

  void clear() {
    bends.clear();
    sources_of_parts.clear();
  }
};

/// Finds the bends of a border: the places where its shortest paths change their pseudo-source.
class BendSearch {
 public:
  /// The arguments must outlive the search; `found`, which must be empty, receives the bends.
  BendSearch(const BorderTracer& tracer, const BorderAccuracy& accuracy, BorderBends& found)
      : tracer_(tracer), accuracy_(accuracy), found_(found) {}

  /// Finds the bend, if any, when at most one pseudo-source differs between the ends of the border. It need not lie
  /// over the chord. Returns false, and finds nothing, if paths from other pseudo-sources may be shorter in between.
  bool find_by_ends();
  /// Finds bends between sample points, which are the quadrature points `probes` if there are any. Without them their
  /// number depends on that of the images. Finds `all`, or those that matter for areas. Returns false if the border is
  /// not found.
  bool find_by_samples(bool all, std::span<const BorderPoint> probes, int extra_images);

 private:
  bool find_labelled_end(bool at_end, LabelledPoint& result) const;
  bool is_shortest_between(const LabelledPoint& first, const LabelledPoint& last, const PseudoSources& sources,
                           const PseudoSources& others) const;
  bool find_bends_between(LabelledPoint first, const LabelledPoint& last, bool all);
  bool has_no_bend_between(const LabelledPoint& first, const LabelledPoint& last) const;
  bool is_smooth_transition(const PseudoSource& one, const PseudoSource& other) const;
  bool find_transition(const LabelledPoint& first, const LabelledPoint& last, std::size_t side,
                       LabelledPoint& transition) const;
  void add_bend(const LabelledPoint& bend, const PseudoSources& before);

  const BorderTracer& tracer_;
  const BorderAccuracy& accuracy_;
  BorderBends& found_;
};

}  // namespace supple::voronoi
