#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "report.h"
#include "supple/surface/geodesic_solver.h"

/// The studies of the geodesic benchmark. Each writes a section of geodesics.md.
namespace supple::bench {

struct Settings {
  /// Small meshes and few repetitions: shows that the program works, not what the numbers are.
  bool brief = false;
  std::filesystem::path folder = "docs/bench";
};

struct BenchMesh {
  std::string name;
  std::function<surface::TriangleMesh()> make;
  bool many_windows = false;  ///< shallow bumps split wave fronts: an edge has about 20 windows
};

std::shared_ptr<const surface::TriangleMesh> make_shared_mesh(const BenchMesh& mesh);

using PointPair = std::pair<surface::SurfacePoint, surface::SurfacePoint>;

/// Pairs of points uniform by area on the same component.
std::vector<PointPair> far_pairs(const surface::TriangleMesh& mesh, int n, std::uint64_t seed);
/// Pairs a straightest path of `edges` mean edge lengths apart, in random directions; nearer where the path meets the
/// boundary.
std::vector<PointPair> near_pairs(const surface::TriangleMesh& mesh, int n, double edges, std::uint64_t seed);

void study_accuracy(const Settings& settings);
void study_one_to_all(const Settings& settings);
/// Far pairs and near pairs.
void study_pairs(const Settings& settings);
void study_large_mesh(const Settings& settings);
void study_throughput(const Settings& settings);
void study_effects(const Settings& settings);

}  // namespace supple::bench
