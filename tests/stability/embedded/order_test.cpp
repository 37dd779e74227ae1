// The answer does not depend on how points and faces are numbered.
#include <algorithm>
#include <memory>
#include <numeric>

#include "random_springs.h"

namespace supple::embedded {
namespace {

std::vector<std::int32_t> shuffled(std::size_t count, RandomStream& random) {
  std::vector<std::int32_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
  return order;
}

/// The same network with another numbering of points.
Network renumbered(const Network& network, const std::vector<std::int32_t>& number) {
  Network other = network;
  const auto at = [&](std::int32_t point) { return number[static_cast<std::size_t>(point)]; };
  for (std::size_t i = 0; i < network.points.size(); ++i)
    other.points[static_cast<std::size_t>(number[i])] = network.points[i];
  for (Spring& spring : other.springs) {
    spring.from = at(spring.from);
    spring.to = at(spring.to);
  }
  for (std::int32_t& point : other.fixed_points) point = at(point);
  return other;
}

/// The same network on the mesh with its faces in another order and with another first corner.
std::unique_ptr<NetworkCase> with_other_faces(const NetworkCase& hard, RandomStream& random) {
  const std::vector<std::int32_t> face = shuffled(static_cast<std::size_t>(hard.mesh->face_count()), random);
  std::vector<surface::Triangle> faces(face.size());
  std::vector<int> turns(face.size());
  for (std::size_t f = 0; f < face.size(); ++f) {
    surface::Triangle corners = hard.mesh->faces()[static_cast<std::int32_t>(f)];
    turns[f] = random.below(3);
    std::rotate(corners.begin(), corners.begin() + turns[f], corners.end());
    faces[static_cast<std::size_t>(face[f])] = corners;
  }
  auto same = std::make_unique<NetworkCase>(surface::TriangleMesh::build(hard.mesh->positions(), std::move(faces)));
  same->network = hard.network;
  for (surface::SurfacePoint& point : same->network.points) {
    const auto f = static_cast<std::size_t>(index(point.face));
    Eigen::Vector3d turned;
    for (int k = 0; k < 3; ++k) turned[k] = point.barycentric[(k + turns[f]) % 3];
    point.face = FaceId{face[f]};
    point.barycentric = turned;
  }
  return same;
}

// Hard: with compressed springs there are many equilibria, and rounding depends on the order of sums.
TEST(Order, OfPointsAndFacesDoesNotChangeTheAnswer) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomStream random("order", seed);
    NetworkCase hard(testing::torus(24, 12));
    draw_network(hard, {.points = 20, .to_nearest = true, .shortest = 0.8, .longest = 1.2, .fixed = 3}, random);
    const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);

    const Network other = renumbered(hard.network, shuffled(hard.network.points.size(), random));
    EXPECT_NEAR(relax(hard.solver, other, hard.options).energy, relaxed.energy, 1e-9 * relaxed.energy);

    const auto same = with_other_faces(hard, random);
    EXPECT_NEAR(relax(same->solver, same->network, same->options).energy, relaxed.energy, 1e-9 * relaxed.energy);
  }
}

// Hard: far from equilibrium the Hessian is indefinite, and its regularization decides which equilibrium is found. It
// must not depend on the faces' tangent frames, which are given by their first corners.
TEST(Order, OfCornersDoesNotChooseAmongEquilibria) {
  int others = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    RandomStream random("order of corners", seed);
    NetworkCase hard(testing::torus(9, 5));
    draw_network(hard, {.points = 12, .shortest = 0.6, .longest = 1.3, .fixed = 2}, random);
    const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
    const auto same = with_other_faces(hard, random);
    const double energy = relax(same->solver, same->network, same->options).energy;
    others += std::abs(energy - relaxed.energy) > 1e-6 * relaxed.energy;
  }
  EXPECT_EQ(others, 0);
}

}  // namespace
}  // namespace supple::embedded
