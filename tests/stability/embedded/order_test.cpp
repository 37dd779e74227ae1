// The answer does not depend on how points and faces are numbered.
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

// Hard: springs that push have many equilibria, and rounding differs with the order of sums.
TEST(Order, OfPointsAndFacesDoesNotChangeTheAnswer) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomStream random("order", seed);
    NetworkCase hard(testing::torus(24, 12));
    draw_network(hard, {.points = 20, .to_nearest = true, .shortest = 0.8, .longest = 1.2, .fixed = 3}, random);
    const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);

    const Network other = renumbered(hard.network, shuffled(hard.network.points.size(), random));
    EXPECT_NEAR(relax(hard.solver, other, hard.options).energy, relaxed.energy, 1e-9 * relaxed.energy);

    const std::vector<std::int32_t> face = shuffled(static_cast<std::size_t>(hard.mesh->face_count()), random);
    std::vector<surface::Triangle> faces(face.size());
    for (std::size_t f = 0; f < face.size(); ++f)
      faces[static_cast<std::size_t>(face[f])] = hard.mesh->faces()[static_cast<std::int32_t>(f)];
    NetworkCase same(surface::TriangleMesh::build(hard.mesh->positions(), std::move(faces)));
    same.network = hard.network;
    for (surface::SurfacePoint& point : same.network.points)
      point.face = FaceId{face[static_cast<std::size_t>(index(point.face))]};
    EXPECT_NEAR(relax(same.solver, same.network, same.options).energy, relaxed.energy, 1e-9 * relaxed.energy);
  }
}

}  // namespace
}  // namespace supple::embedded
