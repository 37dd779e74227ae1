#pragma once

#include <Eigen/Core>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "supple/numerics/state.h"
#include "supple/surface/moving_points.h"
#include "supple/surface/tangent_geodesic.h"
#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// How a Voronoi vertex moves with its sites (thesis eq. A.23): its tangent coordinates change by the sum over them of
/// along (by_site . ds).
struct VertexMotion {
  std::vector<SitePull> pulls;
  std::vector<Eigen::Vector2d> along;
};

/// What is known of a diagram at one state, as far as it was asked for.
struct Found {
  Diagram diagram;
  std::vector<VertexMotion> motions;                   ///< of the vertices
  std::vector<std::int32_t> measured_edges;            ///< edges between two vertices
  std::vector<surface::TangentGeodesic> edge_lengths;  ///< of these, from the first vertex to the second
};

/// Sites that move on a surface, and the diagram where they are.
class SitesState {
 public:
  /// `mesh` outlives the state.
  SitesState(const surface::TriangleMesh& mesh, std::vector<surface::SurfacePoint> sites)
      : mesh_(&mesh), sites_(mesh, std::move(sites)) {}

  void stop_with(const CancellationToken& cancellation) { sites_.stop_with(cancellation); }

  const surface::TriangleMesh& mesh() const { return *mesh_; }
  const surface::MovingPoints& sites() const { return sites_; }

  /// Null before it is found.
  const std::shared_ptr<Found>& found() const { return found_; }
  void set_found(std::shared_ptr<Found> found) { found_ = std::move(found); }

  static constexpr std::string_view motion = "motion";
  Eigen::Index dimension() const { return sites_.dimension(); }
  Eigen::VectorXd move(const Eigen::VectorXd& step) {
    found_.reset();
    return sites_.move(*mesh_, step);
  }
  void take_frame() {}
  bool transport(Eigen::VectorXd& tangent) const {
    sites_.transport(tangent);
    return true;
  }

 private:
  const surface::TriangleMesh* mesh_;
  surface::MovingPoints sites_;
  std::shared_ptr<Found> found_;
};

}  // namespace supple::voronoi
