// One solver and one field under many threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <barrier>
#include <cstring>
#include <memory>
#include <thread>
#include <vector>

#include "supple/surface/geodesic_solver.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

constexpr int number_of_threads = 8;

void append(std::vector<double>& values, const Geodesic& geodesic) {
  values.push_back(geodesic.distance);
  values.push_back(geodesic.competing_excess);
  for (const PathPoint& p : geodesic.path) values.insert(values.end(), p.position.data(), p.position.data() + 3);
  if (!geodesic.derivatives) return;
  const auto& hessian = geodesic.derivatives->hessian;
  values.insert(values.end(), hessian.data(), hessian.data() + hessian.size());
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(GeodesicThreads, ThreadsThatShareASolverAndAFieldGetTheSameBitsAsOneThread) {
  const auto mesh = std::make_shared<const TriangleMesh>(supple::testing::genus3());
  RandomStream stream("shared solver", 5);
  const supple::testing::SurfaceSampler sampler(*mesh);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 48; ++i) points.push_back(sampler.point(stream));
  FieldOptions kept;
  kept.keep_windows = true;
  GeodesicOptions all;
  all.path = true;
  all.derivatives = 2;

  // Task i mixes every kind of query; what it returns must not depend on what the search it borrows did before.
  const auto run = [&](const GeodesicSolver& solver, const GeodesicField& field, int i) {
    const std::size_t a = i, b = (7 * i + 3) % points.size();
    std::vector<double> values;
    append(values, solver.geodesic(points[a], points[b], all));
    append(values, field.geodesic(points[b], all));
    for (const Geodesic& g : solver.geodesics(points[a], {points.data(), 5})) append(values, g);
    if (i % 4 == 0) {
      const std::vector<double> distances = solver.field({&points[a], 1}).vertex_distances();
      values.insert(values.end(), distances.begin(), distances.end());
    }
    return values;
  };
  std::vector<std::vector<double>> expected;
  {
    const GeodesicSolver solver(mesh);
    const GeodesicField field = solver.field({points.data(), 3}, kept);
    for (int i = 0; i < static_cast<int>(points.size()); ++i) expected.push_back(run(solver, field, i));
  }

  const GeodesicSolver solver(mesh);
  const GeodesicField field = solver.field({points.data(), 3}, kept);
  std::vector<int> differing(number_of_threads, 0);
  std::barrier start(number_of_threads);
  std::vector<std::thread> threads;
  for (int t = 0; t < number_of_threads; ++t) {
    threads.emplace_back([&, t] {
      start.arrive_and_wait();
      for (std::size_t k = 0; k < points.size(); ++k) {
        const int i = static_cast<int>((k * 5 + 11 * t) % points.size());  // each thread in an order of its own
        if (!same_bits(run(solver, field, i), expected[i])) ++differing[t];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(differing, std::vector<int>(number_of_threads, 0));
}

}  // namespace
}  // namespace supple::surface
