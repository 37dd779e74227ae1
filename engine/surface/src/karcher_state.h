#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "anchor_distances.h"
#include "supple/surface/retraction.h"

namespace supple::surface {

/// A point that moves on a surface, and what was found of its distances to the anchors.
class KarcherState {
 public:
  /// `mesh` outlives the state.
  KarcherState(const TriangleMesh& mesh, const SurfacePoint& point)
      : mesh_(&mesh), point_(point), on_tip_(on_cone_tip(mesh, point)) {}

  /// What moves look at on their way; without it nothing stops them.
  void stop_with(const CancellationToken& cancellation) { cancellation_ = cancellation; }

  const SurfacePoint& point() const { return point_; }
  bool on_tip() const { return on_tip_; }

  /// One for each anchor: with derivatives, on a tip with directions instead; null before they are found.
  const std::vector<AnchorGeodesic>* found() const { return found_.get(); }
  void set_found(std::vector<AnchorGeodesic> found) {
    found_ = std::make_shared<const std::vector<AnchorGeodesic>>(std::move(found));
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
  double turn_ = 0;  ///< of the coordinates along the last move
  bool isometric_ = true;
  std::shared_ptr<const std::vector<AnchorGeodesic>> found_;
};

}  // namespace supple::surface
