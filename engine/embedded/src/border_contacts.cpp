#include "border_contacts.h"

#include <algorithm>

#include "supple/surface/retraction.h"

namespace supple::embedded {
namespace {

/// A point whose barycentric coordinate is at most this is on the opposite side: rounding leaves one that slides there.
constexpr double max_border_coordinate = 1e-12;

}  // namespace

BorderContacts::BorderContacts(const ElasticNetwork& network, const NetworkState& state) {
  const surface::TriangleMesh& mesh = state.mesh();
  for (const std::size_t point : network.free_points()) {
    if (state.on_tip(point)) continue;
    const surface::SurfacePoint& at = state.points()[point];
    for (int corner = 0; corner < 3; ++corner) {
      // The side opposite a corner begins at the next corner.
      const std::int32_t side = 3 * index(at.face) + (corner + 1) % 3;
      if (at.barycentric[corner] > max_border_coordinate || mesh.twin(side) >= 0) continue;
      const Eigen::Matrix<double, 3, 2> frame = surface::tangent_frame(mesh, at.face);
      const Eigen::Vector2d along =
          frame.transpose() * (mesh.positions()[mesh.head(side)] - mesh.positions()[mesh.tail(side)]);
      contacts_.push_back({static_cast<std::int32_t>(point), Eigen::Vector2d(along.y(), -along.x()).normalized()});
      break;
    }
  }
}

void BorderContacts::keep_pushed(const Eigen::VectorXd& gradient) {
  std::erase_if(contacts_, [&](const BorderContact& contact) {
    return !(gradient.segment<2>(2 * contact.point).dot(contact.outward) < 0);
  });
}

const BorderContact* BorderContacts::of(std::int32_t point) const {
  const auto found = std::ranges::lower_bound(contacts_, point, {}, &BorderContact::point);
  return found != contacts_.end() && found->point == point ? &*found : nullptr;
}

}  // namespace supple::embedded
