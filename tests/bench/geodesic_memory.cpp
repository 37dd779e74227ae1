// Memory and time of far pairs and Karcher means on meshes of more than a million faces.
#include <array>

#include "geodesic_bench.h"
#include "measurement.h"
#include "supple/base/threads.h"
#include "supple/surface/karcher_mean.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using surface::GeodesicOptions;
using surface::GeodesicSolver;

/// What a stage takes, and what the process holds after it and at most on the way, beyond what it held at the start.
struct Cost {
  double seconds;
  double stays_mib;
  double peak_mib;
};

/// The rows of a mesh.
constexpr std::array stage_names{"mesh", "solver", "near pair", "far pair", "another far pair", "Karcher mean"};
using Costs = std::array<Cost, stage_names.size()>;

/// Measured on the version that kept all windows of a search (c98f7d1), while this one was measured beside it.
constexpr Costs sphere_before{{{0.468, 119, 133},
                               {0.252, 452, 452},
                               {0.0391, 562, 562},
                               {4.53, 1999, 2074},
                               {0.337, 1999, 1999},
                               {73.2, 2171, 2224}}};
constexpr Costs torus_before{{{0.296, 137, 152},
                              {0.232, 517, 517},
                              {0.0422, 643, 643},
                              {5.60, 3236, 3461},
                              {0.0670, 3236, 3237},
                              {208, 3928, 4140}}};

/// A pair is far if its ends are this share of the mesh's diagonal apart in space.
constexpr double far_share = 0.4;

class MemoryStages {
 public:
  MemoryStages() {
    reset_peak_memory();
    start_ = resident_bytes();
  }

  template <typename Action>
  Cost measure(Action&& action) const {
    reset_peak_memory();
    Cost cost{};
    cost.seconds = cpu_time(action);
    cost.peak_mib = mebibytes(peak_resident_bytes());
    reset_peak_memory();  // what was freed goes back to the system
    cost.stays_mib = mebibytes(resident_bytes());
    return cost;
  }

 private:
  double mebibytes(std::int64_t bytes) const { return static_cast<double>(bytes - start_) / (1 << 20); }

  std::int64_t start_;
};

Costs measure_mesh(const BenchMesh& bench_mesh, std::int32_t& faces) {
  const MemoryStages stages;
  Costs costs;
  std::shared_ptr<const surface::TriangleMesh> mesh;
  costs[0] = stages.measure([&] { mesh = make_shared_mesh(bench_mesh); });
  faces = mesh->face_count();
  std::unique_ptr<GeodesicSolver> solver;
  costs[1] = stages.measure([&] { solver = std::make_unique<GeodesicSolver>(mesh); });

  const PointPair near = near_pairs(*mesh, 1, 3, 5)[0];
  std::vector<PointPair> far;
  for (const PointPair& pair : far_pairs(*mesh, 20, 17)) {
    const double straight = (position(*mesh, pair.first) - position(*mesh, pair.second)).norm();
    if (straight > far_share * mesh->diagonal()) far.push_back(pair);
  }
  GeodesicOptions with_path;
  with_path.path = true;
  const auto measure_pair = [&](const PointPair& pair) {
    return stages.measure([&] { keep(solver->geodesic(pair.first, pair.second, with_path).distance); });
  };
  costs[2] = measure_pair(near);
  costs[3] = measure_pair(far[0]);
  costs[4] = measure_pair(far[1]);
  surface::KarcherProblem problem;
  problem.points = {far[0].first, far[0].second, far[1].first, far[1].second};
  costs[5] = stages.measure([&] { keep(karcher_mean(*solver, problem).objective); });
  return costs;
}

void add_rows(Table& table, const BenchMesh& mesh, const Costs* before) {
  std::int32_t faces = 0;
  const Costs costs = measure_mesh(mesh, faces);
  for (std::size_t i = 0; i < stage_names.size(); ++i) {
    std::vector<std::string> row{mesh.name, count(faces), stage_names[i]};
    for (const Cost* cost : {before ? &(*before)[i] : nullptr, &costs[i]}) {
      row.push_back(cost ? number(cost->seconds) : "");
      row.push_back(cost ? count(cost->stays_mib) : "");
      row.push_back(cost ? count(cost->peak_mib) : "");
    }
    table.row(std::move(row));
  }
}

}  // namespace

void measure_memory(Report& report, const Settings& settings) {
  Table table("geodesics-memory", {{"mesh", "Mesh"},
                                   {"faces", "Faces"},
                                   {"stage", "Stage"},
                                   {"before_s", "Before: seconds"},
                                   {"before_stays_mib", "MiB that stay"},
                                   {"before_peak_mib", "MiB at the peak"},
                                   {"s", "Now: seconds"},
                                   {"stays_mib", "MiB that stay"},
                                   {"peak_mib", "MiB at the peak"}});
  const bool brief = settings.brief;
  add_rows(table, {"icosphere", [&] { return testing::icosphere(brief ? 4 : 8); }}, brief ? nullptr : &sphere_before);
  add_rows(table, {"torus", [&] { return brief ? testing::torus() : testing::torus(1376, 544); }},
           brief ? nullptr : &torus_before);
  report.heading("Memory of far pairs and means on a large mesh");
  report.text(
      "Ends of far pairs are more than " + number(far_share) +
      " of the mesh's diagonal apart in space; paths are asked for. The mean is that of the four ends of two far "
      "pairs, "
      "searched by " +
      count(thread_count()) +
      " threads at once. MiB of resident memory beyond what the process held before the mesh, after freed memory has "
      "gone back to the system, and at most while the stage ran; CPU time of all threads.");
  if (!brief) {
    report.text(
        "*Before* is the version that kept every window that a search for a pair had passed (56 bytes each, until the "
        "solver ended), because the path might run through it. It was measured at the same time as *now*, side by side "
        "on the two cores, which slows both; of a mean, during which both ask for two cores, the times say little. "
        "Freeing windows early would not have helped: 89 to 99 % of them had descendants at the front when the target "
        "was found. Now a window takes its way along, one bit for each face, and is forgotten.");
    report.text(
        "What remains is held on purpose. The mesh, and what the solver computes of it once, serve every query. A "
        "search "
        "needs about 100 bytes for each face, because it may reach any; the first query makes them, a mean one set for "
        "each thread, and they are kept so that a near pair costs microseconds. What cannot be saved is the work, tens "
        "of millions of windows for an exact far pair on such a mesh, and the memory of exact fields that are kept for "
        "queries, each of whose windows may be asked for: a mean that is told to keep fields holds one for each "
        "point.");
  }
  report.table(table);
}

}  // namespace supple::bench
