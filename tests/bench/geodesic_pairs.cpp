// One pair of points at a time: far ones against CGAL, and near ones.
#include <algorithm>

#include "geodesic_bench.h"
#include "measurement.h"
#include "support/cgal_geodesics.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using surface::GeodesicOptions;
using surface::GeodesicSolver;
using surface::SurfacePoint;

std::vector<BenchMesh> far_meshes(const Settings& settings) {
  using namespace supple::testing;
  if (settings.brief) return {{"icosphere", [] { return icosphere(4); }}};
  return {{"torus", [] { return torus(); }},
          {"icosphere", [] { return icosphere(5); }},
          {"spiral cup", [] { return spiral_cup(); }},
          {"bumpy cube, shallow", [] { return bumpy_cube(); }},
          {"bumpy cube, steep", [] { return bumpy_cube(58, 12, 0.03); }},
          {"trefoil knot", [] { return trefoil_knot(640, 48); }},
          {"icosphere", [] { return icosphere(6); }}};
}

struct NearMesh {
  BenchMesh mesh;
  bool small = false;  ///< the smaller of a shape's two sizes, which are to take the same time
  bool large = false;
};

std::vector<NearMesh> near_meshes(const Settings& settings) {
  using namespace supple::testing;
  if (settings.brief) {
    return {{{"torus", [] { return torus(); }}, true, false}, {{"torus", [] { return torus(96, 48); }}, false, true}};
  }
  return {{{"torus", [] { return torus(); }}, true, false},
          {{"torus", [] { return torus(400, 200); }}, false, true},
          {{"icosphere", [] { return icosphere(3); }}},
          {{"icosphere", [] { return icosphere(6); }}},
          {{"genus 3", [] { return genus3(20); }}},
          {{"spiral cup", [] { return spiral_cup(); }}},
          {{"bumpy cube, shallow", [] { return bumpy_cube(); }}},
          {{"bumpy cube, steep", [] { return bumpy_cube(58, 12, 0.03); }}}};
}

GeodesicOptions with(bool path, int derivatives) {
  GeodesicOptions options;
  options.path = path;
  options.derivatives = derivatives;
  return options;
}

/// Mean seconds of a query, and the time within which 99 % of the pairs are answered.
struct QueryTimes {
  double mean = 0;
  double p99 = 0;
};

/// Statistics of each pair's least wall time over some passes, which leaves out the times of other programs. All pairs
/// take turns in each pass, so that a pair's neighbourhood is not in the cache from the pass before.
std::vector<QueryTimes> query_times(const GeodesicSolver& solver, const std::vector<PointPair>& pairs,
                                    const std::vector<GeodesicOptions>& variants, int passes) {
  std::vector<std::vector<double>> best(variants.size(), std::vector<double>(pairs.size(), 1e9));
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t k = 0; k < variants.size(); ++k) {
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        const double start = wall_seconds();
        keep(solver.geodesic(pairs[i].first, pairs[i].second, variants[k]).distance);
        best[k][i] = std::min(best[k][i], wall_seconds() - start);
      }
    }
  }
  std::vector<QueryTimes> times;
  for (const std::vector<double>& b : best) times.push_back({mean(b), quantile(b, 0.99)});
  return times;
}

std::string microseconds(double seconds) { return number(1e6 * seconds); }

void measure_far_pairs(Report& report, const Settings& settings) {
  Table table("geodesics-far-pairs", {{"mesh", "Mesh"},
                                      {"faces", "Faces"},
                                      {"ours_ms", "Ours, median ms"},
                                      {"ours_p90_ms", "Ours, 90 % within, ms"},
                                      {"cgal_ms", "CGAL, median ms"},
                                      {"ratio", "CGAL / ours"}});
  std::vector<double> all_ratios;
  double worst = 1e9;
  for (const BenchMesh& bench_mesh : far_meshes(settings)) {
    const auto mesh = make_shared_mesh(bench_mesh);
    const GeodesicSolver solver(mesh);
    testing::CgalGeodesics cgal(*mesh);
    const std::vector<PointPair> pairs = far_pairs(*mesh, settings.brief ? 20 : 100, 17);
    const int shared = settings.brief ? 2 : mesh->face_count() < 10'000 ? 20 : mesh->face_count() < 50'000 ? 4 : 2;
    std::vector<double> ours, peer;
    keep(solver.distance(pairs[0].first, pairs[0].second));
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const SurfacePoint& from = pairs[i].first;
      const SurfacePoint& to = pairs[i].second;
      double best = 1e9;
      for (int pass = 0; pass < 3; ++pass) best = std::min(best, cpu_time([&] { keep(solver.distance(from, to)); }));
      ours.push_back(best);
      if (static_cast<int>(i) >= shared) continue;
      cgal.set_source(from);
      peer.push_back(cpu_time([&] {
        cgal.search();
        keep(cgal.distance(to));
      }));
    }
    const double ratio = median(peer) / median(ours);
    worst = std::min(worst, ratio);
    all_ratios.push_back(ratio);
    table.row({bench_mesh.name, count(mesh->face_count()), number(1e3 * median(ours)),
               number(1e3 * quantile(ours, 0.9)), number(1e3 * median(peer)), number(ratio)});
  }
  report.target("Far pair: CGAL's median time over ours, on every mesh", "at least 100",
                "least " + number(worst) + ", median " + number(median(all_ratios)), worst >= 100);
  report.heading("Far pairs");
  report.text(
      "Both points uniform over the surface; the search is directed at the target. CGAL builds its tree from the first "
      "point and queries it at the second: it has no search for a pair.");
  report.table(table);
}

void measure_near_pairs(Report& report, const Settings& settings) {
  Table table("geodesics-near-pairs", {{"mesh", "Mesh"},
                                       {"faces", "Faces"},
                                       {"distance_us", "Distance, mean us"},
                                       {"distance_p99_us", "99 % within"},
                                       {"path_us", "With path, mean us"},
                                       {"path_p99_us", "99 % within"},
                                       {"hessian_us", "With Hessian, mean us"},
                                       {"hessian_p99_us", "99 % within"}});
  const std::vector<GeodesicOptions> variants{with(false, 0), with(true, 0), with(false, 2)};
  double distance = 0, path = 0, hessian = 0, small = 1, large = 1;
  for (const NearMesh& near_mesh : near_meshes(settings)) {
    const auto mesh = make_shared_mesh(near_mesh.mesh);
    const GeodesicSolver solver(mesh);
    const auto times = query_times(solver, near_pairs(*mesh, settings.brief ? 500 : 4000, 3, 19), variants, 5);
    table.row({near_mesh.mesh.name, count(mesh->face_count()), microseconds(times[0].mean), microseconds(times[0].p99),
               microseconds(times[1].mean), microseconds(times[1].p99), microseconds(times[2].mean),
               microseconds(times[2].p99)});
    distance = std::max(distance, times[0].mean);
    path = std::max(path, times[1].mean);
    hessian = std::max(hessian, times[2].mean - times[0].mean);
    if (near_mesh.small) small = times[0].mean;
    if (near_mesh.large) large = times[0].mean;
  }
  report.target("Near pair, 3 edges apart: mean time on every mesh", "under 8 us",
                "at most " + microseconds(distance) + " us", distance < 8e-6);
  report.target("The same with its path", "under 15 us", "at most " + microseconds(path) + " us", path < 15e-6);
  report.target("What a gradient and Hessian add", "under 5 us", "at most " + microseconds(hessian) + " us",
                hessian < 5e-6);
  report.target("Near pair on a torus of 160,000 faces over one of 2,304", "at most 2", number(large / small),
                large <= 2 * small);
  report.heading("Near pairs");
  report.text(
      "The second point lies a straightest path of 3 *h* from the first, in a random direction. Wall time; each pair's "
      "least of five passes over all pairs, so that the spread is that of the pairs and not of the machine. Nothing "
      "here grows with the mesh but cache misses.");
  report.table(table);
}

}  // namespace

void study_pairs(const Settings& settings) {
  Report report(settings.folder, "geodesics", "pairs", "Pairs of points");
  measure_far_pairs(report, settings);
  measure_near_pairs(report, settings);
  report.write("bench_geodesics pairs", settings.brief,
               "Times are CPU time of one thread unless they are called wall time.");
}

}  // namespace supple::bench
