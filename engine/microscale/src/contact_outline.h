#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/tiling/mesh.h"

namespace supple::microscale {

/// The outlines of a patch's holes as chains of straight contact segments. Each quadratic side gives two segments, from
/// corner to midpoint to corner. Points and segments are periodic. An image is one of them moved by a lattice shift, an
/// integer combination of the translations.
struct ContactOutline {
  struct Segment {
    int tail = 0;  ///< index of a point
    int head = 0;
    /// Lattice shift of the head relative to the tail.
    Eigen::Vector2i head_shift = Eigen::Vector2i::Zero();
    /// The segment that begins where this one ends; -1 if more than one chain passes through the head.
    int next = -1;
  };

  explicit ContactOutline(const tiling::PeriodicMesh& mesh);

  int points() const { return static_cast<int>(nodes.size()); }
  /// Rest position of a segment's end, for the image of the segment that is moved by `shift`.
  Eigen::Vector2d rest_tail(const Segment& segment, const Eigen::Vector2i& shift) const;
  Eigen::Vector2d rest_head(const Segment& segment, const Eigen::Vector2i& shift) const;

  Eigen::Matrix2d lattice;      ///< columns: the translations at rest, mm
  std::vector<int> nodes;       ///< for each point its node of the mesh
  Eigen::Matrix2Xd rest;        ///< rest positions of the points, mm
  std::vector<double> lengths;  ///< rest length of outline assigned to each point: half of each segment at it, mm
  std::vector<Segment> segments;
};

/// Writes the periodic displacements of the outline's points, which it takes from x (as in cell_coordinates.h).
void gather_displacements(const ContactOutline& outline, const Eigen::VectorXd& x, Eigen::Matrix2Xd& into);

/// Whether two contact segments, or images of them, cross each other at x. Takes about 0.1 us for each segment.
bool intersects(const ContactOutline& outline, const Eigen::VectorXd& x);

}  // namespace supple::microscale
