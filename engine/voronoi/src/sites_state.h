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

/// How a Voronoi vertex moves with its sites [Thesis, eq. A.23]: its tangent coordinates change by the sum over the
/// sites of direction * (by_site . ds), ds: the site's displacement.
struct VertexMotion {
  std::vector<SiteDistanceGradient> gradients;  ///< distances from the sites and their gradients
  std::vector<Eigen::Vector2d> directions;      ///< one for each site
};

/// The diagram of a state and the requested quantities of it.
struct DiagramEvaluation {
  Diagram diagram;
  std::vector<VertexMotion> motions;                   ///< motions of the Voronoi vertices
  std::vector<std::int32_t> measured_edges;            ///< indices of the edges between two vertices
  std::vector<surface::TangentGeodesic> edge_lengths;  ///< their geodesics, from the first vertex to the second
};

/// Sites that move on a surface, and the diagram of their positions.
class SitesState {
 public:
  /// `mesh` must outlive the state.
  SitesState(const surface::TriangleMesh& mesh, std::vector<surface::SurfacePoint> sites)
      : mesh_(&mesh), sites_(mesh, std::move(sites)) {}

  void stop_with(const CancellationToken& cancellation) { sites_.stop_with(cancellation); }

  const surface::TriangleMesh& mesh() const { return *mesh_; }
  const surface::MovingPoints& sites() const { return sites_; }

  /// Null if the state has not been evaluated.
  const std::shared_ptr<DiagramEvaluation>& evaluation() const { return evaluation_; }
  void set_evaluation(std::shared_ptr<DiagramEvaluation> evaluation) { evaluation_ = std::move(evaluation); }

  static constexpr std::string_view motion = "motion";
  Eigen::Index dimension() const { return sites_.dimension(); }
  Eigen::VectorXd move(const Eigen::VectorXd& step) {
    evaluation_.reset();
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
  std::shared_ptr<DiagramEvaluation> evaluation_;
};

}  // namespace supple::voronoi
