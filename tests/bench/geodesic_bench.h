#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "report.h"
#include "supple/surface/geodesic_solver.h"

/// The sections of the geodesic benchmark, in the order of the page. Each adds its tables and targets to the report.
namespace supple::bench {

struct Settings {
  /// Small meshes and few repetitions: shows that the program works, not what the numbers are.
  bool brief = false;
};

struct BenchMesh {
  std::string name;
  std::function<surface::TriangleMesh()> make;
  bool many_windows = false;  ///< shallow bumps split wave fronts: about 20 windows on each edge
};

std::shared_ptr<const surface::TriangleMesh> make_shared_mesh(const BenchMesh& mesh);

using PointPair = std::pair<surface::SurfacePoint, surface::SurfacePoint>;

/// Pairs of points uniform by area on the same component.
std::vector<PointPair> far_pairs(const surface::TriangleMesh& mesh, int n, std::uint64_t seed);
/// Pairs a straightest path of `edges` mean edge lengths apart, in random directions (fewer edges where it met the
/// boundary).
std::vector<PointPair> near_pairs(const surface::TriangleMesh& mesh, int n, double edges, std::uint64_t seed);

void measure_one_to_all(Report& report, const Settings& settings);
void measure_far_pairs(Report& report, const Settings& settings);
void measure_near_pairs(Report& report, const Settings& settings);
void measure_springs(Report& report, const Settings& settings);
void measure_large_mesh(Report& report, const Settings& settings);
void measure_memory(Report& report, const Settings& settings);
void measure_order(Report& report, const Settings& settings);
void measure_throughput(Report& report, const Settings& settings);
void measure_accuracy(Report& report, const Settings& settings);
void measure_effects(Report& report, const Settings& settings);
/// Pages of their own.
void measure_parts(Report& report, const Settings& settings);
void measure_mollifier(Report& report, const Settings& settings);

}  // namespace supple::bench
