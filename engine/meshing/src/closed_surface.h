#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "supple/meshing/tetrahedral_mesh.h"

namespace supple::meshing {

/// A connected solid: numbers of the surface's components that bound it, the outer one first, then its cavities'.
using Solid = std::vector<std::size_t>;

/// A surface without boundary, its components, and the solids that they bound.
class ClosedSurface {
 public:
  /// Throws what `fill` throws for the surface's connectivity. O(n log n) for one component.
  ClosedSurface(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces);

  /// Triangles of each component.
  const std::vector<std::vector<SurfaceTriangle>>& components() const { return components_; }
  const std::vector<Solid>& solids() const { return solids_; }
  /// The volume of a solid, without its cavities.
  double volume(const Solid& solid) const;

 private:
  void find_components(std::span<const SurfaceTriangle> faces);
  void find_solids();
  /// Whether a component winds around the point.
  bool encloses(std::size_t component, const Eigen::Vector3d& point) const;

  std::span<const Eigen::Vector3d> positions_;
  std::vector<std::vector<SurfaceTriangle>> components_;
  std::vector<double> volumes_;  ///< absolute value of each component's enclosed volume
  std::vector<Solid> solids_;
};

}  // namespace supple::meshing
