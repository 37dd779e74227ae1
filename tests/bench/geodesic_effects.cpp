// Cost of each part of an answer that a query may leave out.
#include <algorithm>
#include <functional>

#include "geodesic_bench.h"
#include "measurement.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using surface::FieldOptions;
using surface::Geodesic;
using surface::GeodesicOptions;
using surface::GeodesicSolver;
using surface::PathPoint;

struct Effect {
  std::string name;
  std::function<void(std::size_t)> query;
};

/// Median CPU seconds of one query, the effects taking turns. The first effect is the one that the others add to.
std::vector<double> times_of(const std::vector<Effect>& effects, std::size_t queries, int passes) {
  std::vector<std::vector<double>> times(effects.size());
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t k = 0; k < effects.size(); ++k) {
      times[k].push_back(cpu_time([&] {
                           for (std::size_t i = 0; i < queries; ++i) effects[k].query(i);
                         }) /
                         static_cast<double>(queries));
    }
  }
  std::vector<double> result;
  for (const auto& t : times) result.push_back(median(t));
  return result;
}

void add_rows(Table& table, const std::string& query, const std::vector<Effect>& effects, std::size_t queries,
              int passes) {
  const std::vector<double> times = times_of(effects, queries, passes);
  for (std::size_t k = 0; k < effects.size(); ++k) {
    table.row({query, effects[k].name, number(1e6 * times[k]), number(1e6 * (times[k] - times[0])),
               number(times[k] / times[0])});
  }
}

std::vector<Effect> pair_effects(const GeodesicSolver& solver, const std::vector<PointPair>& pairs,
                                 const std::vector<std::vector<PathPoint>>& paths) {
  const auto asking = [&](GeodesicOptions options) {
    return [&solver, &pairs, options](std::size_t i) {
      keep(solver.geodesic(pairs[i].first, pairs[i].second, options).distance);
    };
  };
  GeodesicOptions path, gradient, hessian, mollified;
  path.path = true;
  gradient.derivatives = 1;
  hessian.derivatives = 2;
  mollified.derivatives = 2;
  mollified.mollifier = 1e-6;
  return {{"distance only", asking({})},
          {"and path", asking(path)},
          {"and gradient", asking(gradient)},
          {"and gradient and Hessian", asking(hessian)},
          {"and mollified gradient and Hessian", asking(mollified)},
          {"with its known path as a bound",
           [&](std::size_t i) {
             keep(solver.geodesic(pairs[i].first, pairs[i].second, {}, {}, {.known_path = &paths[i]}).distance);
           }},
          {"without goal direction", [&](std::size_t i) {
             keep(solver.geodesics(pairs[i].first, {&pairs[i].second, 1})[0].distance);
           }}};
}

std::vector<Effect> field_effects(const GeodesicSolver& solver, const std::vector<PointPair>& pairs) {
  const auto asking = [&](FieldOptions options) {
    return [&solver, &pairs, options](std::size_t i) {
      keep(solver.field({&pairs[i].first, 1}, options).vertex_distances()[0]);
    };
  };
  FieldOptions kept, bounded, limited, graph;
  kept.keep_windows = true;
  bounded.relative_error = 0.01;
  limited.max_distance = 10 * solver.mesh().mean_edge_length();
  graph.method = surface::FieldMethod::edge_graph;
  return {{"vertices only, exact", asking({})},
          {"kept for queries at any point", asking(kept)},
          {"within 1 %", asking(bounded)},
          {"no farther than 10 h", asking(limited)},
          {"edge graph", asking(graph)}};
}

}  // namespace

void study_effects(const Settings& settings) {
  Report report(settings.folder, "geodesics", "effects", "What leaving things out saves");
  const auto mesh = std::make_shared<const surface::TriangleMesh>(settings.brief ? testing::spiral_cup(200, 10)
                                                                                 : testing::spiral_cup());
  const GeodesicSolver solver(mesh);
  Table table("geodesics-effects", {{"query", "Query"},
                                    {"effect", "What is asked for"},
                                    {"us", "us"},
                                    {"added_us", "Added us"},
                                    {"factor", "Over the first"}});
  const int passes = settings.brief ? 3 : 7;
  const std::size_t near_count = settings.brief ? 300 : 3000;
  const std::size_t far_count = settings.brief ? 10 : 12;
  for (const bool is_near : {true, false}) {
    const std::vector<PointPair> pairs = is_near ? near_pairs(*mesh, static_cast<int>(near_count), 3, 53)
                                                 : far_pairs(*mesh, static_cast<int>(far_count), 59);
    std::vector<std::vector<PathPoint>> paths;
    GeodesicOptions options;
    options.path = true;
    for (const auto& [from, to] : pairs) paths.push_back(solver.geodesic(from, to, options).path);
    add_rows(table, is_near ? "near pair (3 h)" : "far pair", pair_effects(solver, pairs, paths), pairs.size(), passes);
  }
  const std::vector<PointPair> sources = far_pairs(*mesh, 4, 61);
  add_rows(table, "field", field_effects(solver, sources), sources.size(), passes);
  report.table(table);
  report.write(
      "bench_geodesics effects", settings.brief,
      "On the spiral cup of " + count(mesh->face_count()) +
          " faces; everything but the distance is done only where it is asked for. Mean CPU time of one query.");
}

}  // namespace supple::bench
