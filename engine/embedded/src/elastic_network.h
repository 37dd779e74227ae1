#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "element_energies.h"
#include "network_state.h"
#include "supple/embedded/network.h"

namespace supple::embedded {

/// A network as the solver reads it: the shortest path that each element follows, the elements that meet at each point,
/// and the points that may move. Two triangles with a common side, or a triangle and a spring with the same ends, share
/// one path.
///
/// The *force* of a path is the derivative of the energy by its length: positive under tension, negative under
/// compression.
class ElasticNetwork {
 public:
  /// The points at the ends of a path.
  struct PathEnds {
    std::int32_t from;
    std::int32_t to;
  };
  /// A side of a triangle is a path whose ends are two of the corners.
  struct Side {
    std::size_t path;
    int from_corner;
    int to_corner;
  };
  struct Triangle {
    MembraneTriangle given;
    std::array<Side, 3> sides;
    TriangleEnergy energy;
  };

  /// The network is a checked one; `fixed` has an entry for each point.
  ElasticNetwork(const Network& network, std::vector<bool> fixed);

  const std::vector<Spring>& springs() const { return springs_; }  ///< spring i follows path i
  const std::vector<Triangle>& triangles() const { return triangles_; }
  const std::vector<PathEnds>& paths() const { return paths_; }
  const std::vector<bool>& fixed() const { return fixed_; }
  bool is_fixed(std::int32_t point) const { return fixed_[static_cast<std::size_t>(point)]; }
  /// Points that are not fixed and belong to an element.
  const std::vector<std::size_t>& free_points() const { return free_; }
  /// Springs of positive weight at a point.
  const std::vector<std::int32_t>& springs_at(std::size_t point) const { return springs_at_[point]; }
  const std::vector<std::int32_t>& triangles_at(std::size_t point) const { return triangles_at_[point]; }
  std::size_t point_count() const { return fixed_.size(); }

  /// Sum of the second derivatives by the path lengths of the energies at a point: twice the weight for each spring,
  /// and about Young's modulus times thickness for each triangle. Energy per squared mesh unit.
  double stiffness_at(std::size_t point) const;
  /// The elements of one point as a network, whose point 0 it is; `points` are the places of all points.
  Network elements_of(std::size_t point, const std::vector<surface::SurfacePoint>& points) const;

  // At a state whose paths are found:
  double spring_energy(const FoundPaths& found, std::size_t spring) const;
  Eigen::Vector3d side_lengths(const FoundPaths& found, std::size_t triangle) const;
  /// The force of every path.
  std::vector<double> path_forces(const FoundPaths& found) const;
  /// For each point whether it may move and is an end of a path under compression that has another shortest path.
  std::vector<bool> compressed_at_cut_loci(const FoundPaths& found) const;

 private:
  void add_triangle(const MembraneTriangle& given, const std::array<Side, 3>& sides);

  std::vector<Spring> springs_;
  std::vector<Triangle> triangles_;
  MembraneMaterial material_;
  std::vector<PathEnds> paths_;
  std::vector<std::vector<std::int32_t>> springs_at_;
  std::vector<std::vector<std::int32_t>> triangles_at_;
  std::vector<bool> fixed_;
  std::vector<std::size_t> free_;
};

}  // namespace supple::embedded
