// What far pairs and Karcher means keep and need on meshes of more than a million faces.
#include "geodesic_bench.h"
#include "measurement.h"
#include "supple/base/threads.h"
#include "supple/surface/karcher_mean.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using surface::GeodesicOptions;
using surface::GeodesicSolver;

std::string megabytes(std::int64_t bytes) { return count(static_cast<double>(bytes) / (1 << 20)); }

void measure_mesh(Table& table, const BenchMesh& bench_mesh) {
  reset_peak_memory();
  const std::int64_t before = resident_bytes();
  std::int32_t faces = 0;
  const auto stage = [&](const std::string& name, auto&& action) {
    reset_peak_memory();
    const double seconds = cpu_time(action);
    const std::int64_t peak = peak_resident_bytes() - before;
    const std::int64_t freed = resident_bytes();
    reset_peak_memory();
    const std::int64_t stays = resident_bytes() - before;
    table.row({bench_mesh.name, count(faces), name, number(seconds), megabytes(stays), megabytes(peak)});
    return freed;
  };
  std::shared_ptr<const surface::TriangleMesh> mesh;
  stage("mesh", [&] {
    mesh = make_shared_mesh(bench_mesh);
    faces = mesh->face_count();
  });
  std::unique_ptr<GeodesicSolver> solver;
  stage("solver", [&] { solver = std::make_unique<GeodesicSolver>(mesh); });
  const auto near = near_pairs(*mesh, 1, 3, 5);
  const auto far = far_pairs(*mesh, 3, 17);
  GeodesicOptions with_path;
  with_path.path = true;
  const auto pair = [&](const PointPair& ends) {
    return [&] { keep(solver->geodesic(ends.first, ends.second, with_path).distance); };
  };
  stage("first near pair", pair(near[0]));
  stage("first far pair", pair(far[0]));
  stage("second far pair", pair(far[1]));
  surface::KarcherProblem problem;
  problem.points = {far[0].first, far[0].second, far[1].first, far[1].second};
  stage("Karcher mean of four far points", [&] { keep(karcher_mean(*solver, problem).objective); });
}

}  // namespace

void measure_memory(Report& report, const Settings& settings) {
  Table table("geodesics-memory", {{"mesh", "Mesh"},
                                   {"faces", "Faces"},
                                   {"stage", "Stage"},
                                   {"s", "Seconds"},
                                   {"stays_mb", "MiB that stay"},
                                   {"peak_mb", "MiB at the peak"}});
  const int scale = settings.brief ? 32 : 1;
  measure_mesh(table, {"icosphere", [&] { return testing::icosphere(settings.brief ? 3 : 8); }});
  measure_mesh(table, {"torus", [&] { return testing::torus(1376 / scale, 544 / scale); }});
  report.heading("Memory of far pairs and means on a large mesh");
  report.table(table);
}

}  // namespace supple::bench
