// What accuracy costs in time: exact fields, error-bounded fields, and paths over the edge graph.
#include <algorithm>
#include <cmath>
#include <limits>

#include "geodesic_bench.h"
#include "measurement.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using surface::FieldMethod;
using surface::FieldOptions;
using surface::GeodesicField;
using surface::GeodesicSolver;
using surface::SurfacePoint;

struct Variant {
  std::string name;
  FieldOptions options;
};

std::vector<Variant> variants() {
  std::vector<Variant> result{{"exact", {}}};
  for (const double error : {1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.3}) {
    FieldOptions options;
    options.relative_error = error;
    result.push_back({"relative_error " + number(error, 1), options});
  }
  FieldOptions graph;
  graph.method = FieldMethod::edge_graph;
  result.push_back({"edge_graph", graph});
  return result;
}

std::vector<BenchMesh> accuracy_meshes(const Settings& settings) {
  using namespace supple::testing;
  if (settings.brief) return {{"icosphere", [] { return icosphere(4); }}};
  return {{"icosphere", [] { return icosphere(6); }},
          {"spiral cup", [] { return spiral_cup(); }},
          {"bumpy cube, shallow", [] { return bumpy_cube(); }}};
}

struct FieldErrors {
  double most = 0;
  double sum = 0;
  std::int64_t count = 0;

  void add(const std::vector<double>& distances, const std::vector<double>& exact) {
    for (std::size_t v = 0; v < exact.size(); ++v) {
      if (!(exact[v] > 0)) continue;
      const double error = std::abs(distances[v] / exact[v] - 1);
      most = std::max(most, error);
      sum += error;
      ++count;
    }
  }
};

}  // namespace

void study_accuracy(const Settings& settings) {
  Report report(settings.folder, "geodesics", "accuracy", "Error against time of distance fields");
  Table table("geodesics-accuracy", {{"mesh", "Mesh"},
                                     {"faces", "Faces"},
                                     {"method", "Method"},
                                     {"bound", "Guaranteed relative error"},
                                     {"max_error", "Largest error met"},
                                     {"mean_error", "Mean error"},
                                     {"ms", "Median ms"},
                                     {"windows_per_face", "Windows per face"}});
  bool bounds_hold = true;
  double most_of_bound = 0;
  const int repetitions = settings.brief ? 2 : 5;
  for (const BenchMesh& bench_mesh : accuracy_meshes(settings)) {
    const auto mesh = make_shared_mesh(bench_mesh);
    const GeodesicSolver solver(mesh);
    const testing::SurfaceSampler sampler(*mesh);
    RandomStream stream("accuracy", 47);
    const std::vector<Variant> all = variants();
    std::vector<std::vector<double>> times(all.size());
    std::vector<FieldErrors> errors(all.size());
    std::vector<double> windows(all.size(), 0);
    for (int r = 0; r < repetitions; ++r) {
      const SurfacePoint source = sampler.point(stream);
      const std::vector<double> exact = solver.field({&source, 1}).vertex_distances();
      for (std::size_t k = 0; k < all.size(); ++k) {
        double best = std::numeric_limits<double>::infinity();
        for (int pass = 0; pass < 2; ++pass) {
          const double start = cpu_seconds();
          const GeodesicField field = solver.field({&source, 1}, all[k].options);
          best = std::min(best, cpu_seconds() - start);
          if (pass > 0) continue;
          errors[k].add(field.vertex_distances(), exact);
          windows[k] += static_cast<double>(field.window_count());
        }
        times[k].push_back(best);
      }
    }
    for (std::size_t k = 0; k < all.size(); ++k) {
      const bool graph = all[k].options.method == FieldMethod::edge_graph;
      const double bound = all[k].options.relative_error;
      if (!graph && bound > 0) {
        bounds_hold = bounds_hold && errors[k].most <= bound * (1 + 1e-9);
        most_of_bound = std::max(most_of_bound, errors[k].most / bound);
      }
      table.row({bench_mesh.name, count(mesh->face_count()), all[k].name, graph ? "none" : number(bound, 1),
                 number(errors[k].most), number(errors[k].sum / static_cast<double>(errors[k].count)),
                 number(1e3 * median(times[k])),
                 graph ? "none" : number(windows[k] / repetitions / mesh->face_count())});
    }
  }
  report.target("Error-bounded fields keep their bound", "error over bound at most 1",
                "at most " + number(most_of_bound), bounds_hold);
  report.table(table);
  report.image("geodesics-accuracy.svg", "Error against time of distance fields");
  report.write("bench_geodesics accuracy", settings.brief,
               "Distances from one random source to every vertex, against the exact ones; another source in each of " +
                   std::to_string(repetitions) +
                   " repetitions. `relative_error` is a guarantee; `edge_graph` is Dijkstra's algorithm over edges and "
                   "across pairs of faces, an upper bound without one.");
}

}  // namespace supple::bench
