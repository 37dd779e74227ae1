#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "anchor_distances.h"
#include "supple/surface/retraction.h"

namespace supple::surface {

/// The vertex at which a point lies; -1 for a point at none.
inline std::int32_t vertex_of(const TriangleMesh& mesh, const SurfacePoint& point) {
  const int corner = corner_of(point);
  return corner < 0 ? -1 : mesh.faces()[index(point.face)][corner];
}

/// A point that moves on a surface, with its geodesics to the anchors.
class KarcherState {
 public:
  /// `mesh` must outlive the state.
  KarcherState(const TriangleMesh& mesh, const SurfacePoint& point)
      : mesh_(&mesh), point_(point), on_tip_(on_cone_tip(mesh, point)) {}

  /// Sets the token that moves check.
  void stop_with(const CancellationToken& cancellation) { cancellation_ = cancellation; }

  const SurfacePoint& point() const { return point_; }
  bool on_tip() const { return on_tip_; }

  /// The geodesics to all anchors, with derivatives or, at a tip, with directions. Null before they are computed.
  const std::vector<AnchorGeodesic>* geodesics() const { return geodesics_.get(); }
  void set_geodesics(std::vector<AnchorGeodesic> geodesics) {
    geodesics_ = std::make_shared<const std::vector<AnchorGeodesic>>(std::move(geodesics));
  }

  static constexpr std::string_view motion = "step";
  Eigen::Index dimension() const { return 2; }
  Eigen::VectorXd move(const Eigen::VectorXd& step);
  void take_frame() {}
  bool transport(Eigen::VectorXd& tangent) const;

 private:
  const TriangleMesh* mesh_;
  CancellationToken cancellation_;
  SurfacePoint point_;
  bool on_tip_;
  double turn_ = 0;  ///< angle (radians) by which the last move turned the coordinates
  bool isometric_ = true;
  std::shared_ptr<const std::vector<AnchorGeodesic>> geodesics_;
};

}  // namespace supple::surface
