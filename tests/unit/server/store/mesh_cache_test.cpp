#include "supple/store/mesh_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <optional>
#include <thread>
#include <vector>

#include "supple/base/error.h"
#include "supple/store/local_store.h"
#include "supple/surface/mesh_io.h"
#include "support/temporary_folder.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

class MeshCacheTest : public ::testing::Test {
 protected:
  /// Adds a right triangle with legs of length `size`.
  std::string add_triangle(double size) {
    const auto mesh = surface::TriangleMesh::build({{0, 0, 0}, {size, 0, 0}, {0, size, 0}}, {{0, 1, 2}});
    return store_.meshes().add_mesh(surface::write_ply(mesh), [](auto&, auto) { return "{}"; }).first.id;
  }

  /// Adds a flat square of so many cells along each side.
  std::string add_grid(int side) {
    surface::TriangleSoup grid;
    for (int i = 0; i <= side; ++i)
      for (int j = 0; j <= side; ++j) grid.positions.emplace_back(i, j, 0);
    for (int i = 0; i < side; ++i)
      for (int j = 0; j < side; ++j) {
        const auto at = [&](int a, int b) { return a * (side + 1) + b; };
        grid.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        grid.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    const auto mesh = surface::TriangleMesh::build(std::move(grid.positions), std::move(grid.faces));
    return store_.meshes().add_mesh(surface::write_ply(mesh), [](auto&, auto) { return "{}"; }).first.id;
  }

  const testing::TemporaryFolder temporary_folder_;
  const fs::path folder_ = temporary_folder_.path();
  LocalStore store_{folder_};
};

TEST_F(MeshCacheTest, LoadsAMeshOnceForManyThreads) {
  MeshCache cache(store_.meshes(), 1 << 20);
  const auto id = add_triangle(1);
  std::vector<std::shared_ptr<const LoadedMesh>> got(8);
  std::vector<std::thread> threads;
  for (auto& mesh : got) threads.emplace_back([&] { mesh = cache.get(id); });
  for (auto& thread : threads) thread.join();
  for (const auto& mesh : got) EXPECT_EQ(mesh, got[0]);
  EXPECT_EQ(got[0]->mesh().face_count(), 1);
}

TEST_F(MeshCacheTest, AStopEndsTheMakingOfTheSearchForNearestPointsAndTheNextOneMakesIt) {
  MeshCache cache(store_.meshes(), 1 << 30);
  const auto mesh = cache.get(add_grid(100));
  const Execution stopped;
  stopped.cancellation.request(StopReason::cancelled);
  EXPECT_THROW(mesh->nearest(stopped), Cancelled);
  EXPECT_FALSE(mesh->has_nearest());
  const Eigen::Vector3d corner = mesh->mesh().positions()[0];
  EXPECT_EQ(mesh->nearest().find(corner).position, corner);
  EXPECT_TRUE(mesh->has_nearest());
  EXPECT_EQ(mesh->nearest(stopped).find(corner).position, corner) << "it is made already";
}

TEST_F(MeshCacheTest, AStopEndsTheLoadingAndWhoeverWaitsForItLoadsInTurn) {
  const auto id = add_grid(400);  // 320,000 faces, which load in a tenth of a second or more
  MeshCache cache(store_.meshes(), 1 << 30);
  // Why the loading was stopped; nothing if it was not.
  const auto stop_of = [&](const Execution& execution) -> std::optional<StopReason> {
    try {
      cache.get(id, execution);
    } catch (const Cancelled& stop) {
      return stop.reason();
    }
    return std::nullopt;
  };
  const Execution stopped;
  std::optional<StopReason> ended;
  std::thread first([&] { ended = stop_of(stopped); });
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::shared_ptr<const LoadedMesh> in_turn;
  std::thread second([&] { in_turn = cache.get(id); });
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(cache.find(id), nullptr);
  stopped.cancellation.request(StopReason::cancelled);
  first.join();
  EXPECT_EQ(ended, StopReason::cancelled);
  const Execution late;
  late.cancellation.request(StopReason::deadline);
  EXPECT_EQ(stop_of(late), StopReason::deadline) << "while the other one loads";
  second.join();
  ASSERT_TRUE(in_turn);
  EXPECT_EQ(cache.find(id), in_turn) << "it is held";
  EXPECT_EQ(cache.size().meshes, 1U);
}

TEST_F(MeshCacheTest, AStopEndsTheMakingOfASolverAndTheNextOneMakesIt) {
  MeshCache cache(store_.meshes(), 1 << 30);
  const auto mesh = cache.get(add_grid(200));
  const Execution stopped;
  stopped.cancellation.request(StopReason::deadline);
  EXPECT_THROW(mesh->solver(stopped), Cancelled);
  EXPECT_EQ(&mesh->solver().mesh(), &mesh->mesh());
  EXPECT_EQ(&mesh->solver(stopped), &mesh->solver()) << "it is there";
}

TEST_F(MeshCacheTest, ManyThreadsAskForOneSolver) {
  MeshCache cache(store_.meshes(), 1 << 20);
  const auto mesh = cache.get(add_triangle(1));
  std::vector<const surface::GeodesicSolver*> solvers(8);
  std::vector<std::thread> threads;
  for (auto& solver : solvers) threads.emplace_back([&solver, &mesh] { solver = &mesh->solver(); });
  for (auto& thread : threads) thread.join();
  for (const auto* solver : solvers) EXPECT_EQ(solver, solvers[0]);
  EXPECT_EQ(&solvers[0]->mesh(), &mesh->mesh());
}

TEST_F(MeshCacheTest, LetsGoOfTheMeshThatWasNotUsedForLongest) {
  MeshCache cache(store_.meshes(), 2 * 700);
  const auto a = add_triangle(1);
  const auto b = add_triangle(2);
  const auto c = add_triangle(3);
  const auto first = cache.get(a);
  const auto second = cache.get(b);
  cache.get(a);
  cache.get(c);
  EXPECT_EQ(cache.size().meshes, 2U);
  EXPECT_EQ(cache.get(a), first) << "used more recently than b";
  EXPECT_NE(cache.get(b), second) << "loaded again";
}

TEST_F(MeshCacheTest, HoldsTheLastMeshHoweverLargeItIs) {
  MeshCache cache(store_.meshes(), 1);
  const auto id = add_triangle(1);
  EXPECT_EQ(cache.get(id), cache.get(id));
}

TEST_F(MeshCacheTest, SaysThatThereIsNoSuchMesh) {
  MeshCache cache(store_.meshes(), 1 << 20);
  try {
    cache.get(std::string(64, '0'));
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "mesh.not_found");
  }
  EXPECT_EQ(cache.size().meshes, 0U);
}

TEST_F(MeshCacheTest, KeepsNoTraceOfAMeshThatNoneOfManyThreadsCouldLoad) {
  MeshCache cache(store_.meshes(), 1 << 20);
  for (int round = 0; round < 200; ++round) {
    std::atomic<int> failed{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < 8; ++i) {
      threads.emplace_back([&] {
        try {
          cache.get(std::string(64, '0'));
        } catch (const Error&) {
          ++failed;
        }
      });
    }
    for (auto& thread : threads) thread.join();
    ASSERT_EQ(failed, 8);
    ASSERT_EQ(cache.size().loading, 0U);
  }
}

TEST_F(MeshCacheTest, LoadsAMeshThatWasAcceptedUnderHigherLimits) {
  MeshCache cache(store_.meshes(), 1 << 20);
  // The file has only a header: the error shows that its numbers were accepted and the vertices are missing.
  const auto head = [this](const std::string& vertices) {
    return store_.meshes()
        .add_mesh("ply\nformat binary_little_endian 1.0\nelement vertex " + vertices +
                      "\nproperty double x\nproperty double y\nproperty double z\nelement face 1\n"
                      "property list uchar int vertex_indices\nend_header\n",
                  [](auto&, auto) { return "{}"; })
        .first.id;
  };
  for (const char* vertices : {"1000", "20000001", "9000000000000000000"}) {
    try {
      cache.get(head(vertices));
      FAIL() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), "mesh.malformed") << vertices << ": " << error.what();
    }
  }
}

TEST_F(MeshCacheTest, ForgetsADeletedMesh) {
  MeshCache cache(store_.meshes(), 1 << 20);
  const auto id = add_triangle(1);
  cache.get(id);
  store_.meshes().remove_mesh(id);
  cache.forget(id);
  EXPECT_THROW(cache.get(id), Error);
  EXPECT_EQ(cache.size().bytes, 0);
}

}  // namespace
}  // namespace supple::store
