// What searches hold while they run and what they give back.
#include <gtest/gtest.h>

#include "solver_implementation.h"
#include "supple/base/error.h"
#include "supple/surface/karcher_mean.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

/// Bytes that the four kinds of buffers which grow with a search may retain together.
constexpr auto kept_by_all_buffers = static_cast<std::int64_t>(4 * max_retained_buffer_bytes);

struct FarPair {
  std::shared_ptr<const TriangleMesh> mesh = testing::share(testing::spiral_cup());
  SurfacePoint from = vertex_point(*mesh, VertexId{0});
  SurfacePoint to = vertex_point(*mesh, VertexId{mesh->vertex_count() / 2});
};

TEST(SearchMemory, ASearchForAFarPairHoldsTheWindowsOfItsFrontAndNoneThatHavePassed) {
  const FarPair pair;
  const SearchMesh mesh(pair.mesh);
  WindowSearch search(mesh);
  const SurfacePoint from = rounded_to_vertex(pair.from);
  SearchTarget target = make_target(mesh, pair.to);
  SearchSettings settings;
  settings.goal_directed = true;
  search.run({&from, 1}, {&target, 1}, settings, {});
  ASSERT_LT(target.best.length, infinity);
  ASSERT_GT(search.windows_created(), 500'000);
  const double bytes_of_windows = static_cast<double>(search.windows_created()) * sizeof(Window);
  EXPECT_LT(static_cast<double>(search.buffer_bytes()), 0.1 * bytes_of_windows);
}

TEST(SearchMemory, ASearchThatAsksForNoPathRecordsNoTrail) {
  const FarPair pair;
  const SearchMesh mesh(pair.mesh);
  WindowSearch search(mesh);
  const SurfacePoint from = rounded_to_vertex(pair.from);
  search.run({&from, 1}, {}, {}, {});
  EXPECT_TRUE(search.trails().empty());
}

TEST(SearchMemory, TheWindowsOfAFieldLeaveTheSearchWithTheField) {
  const FarPair pair;
  const SearchMesh mesh(pair.mesh);
  WindowSearch search(mesh);
  const SurfacePoint from = rounded_to_vertex(pair.from);
  SearchSettings settings;
  settings.keep_windows = true;
  search.run({&from, 1}, {}, settings, {});
  const std::size_t while_searching = search.buffer_bytes();
  std::vector<VertexRecord> records;
  LargeVector<Window> windows;
  std::vector<std::int32_t> first;
  search.take_logged_windows(records, windows, first);
  ASSERT_GT(windows.size() * sizeof(Window), 8 * max_retained_buffer_bytes);
  EXPECT_GT(while_searching, windows.size() * sizeof(Window));
  EXPECT_LT(search.buffer_bytes(), while_searching - windows.size() * sizeof(Window) + max_retained_buffer_bytes);
}

TEST(SearchMemory, ASolverHoldsAfterLongQueriesHardlyMoreThanAfterAShortOne) {
  const FarPair pair;
  const GeodesicSolver solver(pair.mesh);
  const SurfacePoint near = vertex_point(*pair.mesh, VertexId{1});
  solver.distance(pair.from, near);
  const std::int64_t before = solver.memory_bytes();
  GeodesicOptions with_path;
  with_path.path = true;
  EXPECT_GT(solver.geodesic(pair.from, pair.to, with_path).path.size(), 100U);
  solver.geodesics(pair.from, std::vector<SurfacePoint>{pair.to, near}, with_path);
  FieldOptions kept;
  kept.keep_windows = true;
  const GeodesicField field = solver.field({&pair.from, 1}, kept);
  ASSERT_GT(field.memory_bytes(), 4 * kept_by_all_buffers);
  EXPECT_LE(solver.memory_bytes(), before + kept_by_all_buffers);
}

/// Asks for a stop once most of the surface has been searched.
class StopLate : public ProgressSink {
 public:
  explicit StopLate(const CancellationToken& token) : token_(token) {}
  void report(double fraction, std::string_view /*stage*/) override {
    if (fraction > 0.8) token_.request(StopReason::cancelled);
  }

 private:
  const CancellationToken& token_;
};

TEST(SearchMemory, ASearchThatWasCancelledGivesBackWhatItHeld) {
  const FarPair pair;
  const GeodesicSolver solver(pair.mesh);
  solver.distance(pair.from, vertex_point(*pair.mesh, VertexId{1}));
  const std::int64_t before = solver.memory_bytes();
  const CancellationToken token;
  StopLate stop(token);
  FieldOptions kept;
  kept.keep_windows = true;
  EXPECT_THROW(solver.field({&pair.from, 1}, kept, {token, &stop, nullptr}), Cancelled);
  EXPECT_LE(solver.memory_bytes(), before + kept_by_all_buffers);
}

}  // namespace
}  // namespace supple::surface
