// One source to every vertex: ours against the building of CGAL's sequence tree; kept fields and their queries.
#include <algorithm>

#include "geodesic_bench.h"
#include "measurement.h"
#include "support/cgal_geodesics.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using surface::FieldOptions;
using surface::GeodesicField;
using surface::GeodesicSolver;
using surface::SurfacePoint;

std::vector<BenchMesh> one_to_all_meshes(const Settings& settings) {
  using namespace supple::testing;
  if (settings.brief) {
    return {{"icosphere", [] { return icosphere(3); }},
            {"torus", [] { return torus(); }},
            {"bumpy cube, shallow", [] { return bumpy_cube(14, 3.5, 0.004); }, true}};
  }
  return {{"icosphere", [] { return icosphere(3); }},
          {"icosphere", [] { return icosphere(4); }},
          {"icosphere", [] { return icosphere(5); }},
          {"icosphere", [] { return icosphere(6); }},
          {"torus", [] { return torus(); }},
          {"torus", [] { return torus(400, 200); }},
          {"genus 3", [] { return genus3(4); }},
          {"genus 3", [] { return genus3(12); }},
          {"genus 3", [] { return genus3(20); }},
          {"saddle", [] { return saddle(30); }},
          {"saddle", [] { return saddle(100); }},
          {"trefoil knot", [] { return trefoil_knot(); }},
          {"trefoil knot", [] { return trefoil_knot(640, 48); }},
          {"spiral cup", [] { return spiral_cup(); }},
          {"bumpy cube, shallow", [] { return bumpy_cube(); }, true},
          {"bumpy cube, steep", [] { return bumpy_cube(58, 12, 0.03); }}};
}

/// Runs `action` until the clock's resolution does not matter, and returns the CPU seconds of one run.
template <typename Action>
double repeated_time(Action&& action) {
  constexpr double min_seconds = 0.01;
  const double first = cpu_time(action);
  const int repetitions = std::clamp(static_cast<int>(min_seconds / std::max(first, 1e-6)), 1, 20);
  return cpu_time([&] {
           for (int i = 0; i < repetitions; ++i) action();
         }) /
         repetitions;
}

/// CGAL takes up to a minute on the largest mesh.
int repetitions_for(std::int32_t faces) { return faces < 10'000 ? 7 : faces < 50'000 ? 3 : faces < 100'000 ? 2 : 1; }

double windows_of(const GeodesicField& field) { return static_cast<double>(field.window_count()); }

struct Row {
  std::string name;
  std::int32_t faces = 0;
  bool many_windows = false;
  double windows_per_face = 0;
  double ratio = 0;
};

struct Tables {
  Table fields{"geodesics-one-to-all",
               {{"mesh", "Mesh"},
                {"faces", "Faces"},
                {"windows_per_face", "Windows per face"},
                {"ns_per_window", "ns per window"},
                {"ours_min_ms", "Ours, least ms"},
                {"ours_ms", "Ours, median ms"},
                {"cgal_min_ms", "CGAL, least ms"},
                {"cgal_ms", "CGAL, median ms"},
                {"ratio", "CGAL / ours"}}};
  Table kept{"geodesics-kept-fields",
             {{"mesh", "Mesh"},
              {"faces", "Faces"},
              {"plain_ms", "Vertices only, ms"},
              {"kept_ms", "Kept, ms"},
              {"bytes_per_face", "Bytes per face"},
              {"ours_query_us", "Ours, one query, us"},
              {"cgal_query_us", "CGAL, one query, us"}}};
};

Row measure(const BenchMesh& bench_mesh, Tables& tables, const Settings& settings) {
  const auto mesh = make_shared_mesh(bench_mesh);
  const GeodesicSolver solver(mesh);
  testing::CgalGeodesics cgal(*mesh);
  const testing::SurfaceSampler sampler(*mesh);
  RandomStream stream("one to all", 3);
  const int repetitions = settings.brief ? 2 : repetitions_for(mesh->face_count());
  const int queries = settings.brief ? 200 : 2000;
  std::vector<double> ours, peer, ratios, windows;
  double our_query = 0, peer_query = 0, bytes = 0, plain = 0, kept_time = 0;
  const SurfacePoint any = sampler.point(stream);
  solver.field({&any, 1});  // the first search makes the state that later ones use again
  FieldOptions keeping;
  keeping.keep_windows = true;
  for (int r = 0; r < repetitions; ++r) {
    const SurfacePoint source = sampler.point(stream);
    ours.push_back(repeated_time([&] { windows.push_back(windows_of(solver.field({&source, 1}))); }));
    cgal.set_source(source);
    peer.push_back(cpu_time([&] { cgal.search(); }));
    ratios.push_back(peer.back() / ours.back());
    if (r + 1 < repetitions) continue;
    kept_time = repeated_time([&] { windows_of(solver.field({&source, 1}, keeping)); });
    const GeodesicField field = solver.field({&source, 1}, keeping);
    bytes = static_cast<double>(field.memory_bytes());
    plain = ours.back();
    std::vector<SurfacePoint> targets;
    for (int i = 0; i < queries; ++i) targets.push_back(sampler.point(stream));
    our_query = cpu_time([&] {
                  for (const SurfacePoint& target : targets) keep(field.distance(target));
                }) /
                queries;
    peer_query = cpu_time([&] {
                   for (const SurfacePoint& target : targets) keep(cgal.distance(target));
                 }) /
                 queries;
  }
  const double faces = mesh->face_count();
  Row row{bench_mesh.name, mesh->face_count(), bench_mesh.many_windows, mean(windows) / faces, median(ratios)};
  tables.fields.row({row.name, count(faces), number(row.windows_per_face), number(1e9 * mean(ours) / mean(windows)),
                     number(1e3 * least(ours)), number(1e3 * median(ours)), number(1e3 * least(peer)),
                     number(1e3 * median(peer)), number(row.ratio)});
  tables.kept.row({row.name, count(faces), number(1e3 * plain), number(1e3 * kept_time), count(bytes / faces),
                   number(1e6 * our_query), number(1e6 * peer_query)});
  return row;
}

std::string measured(const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) {
    text += (text.empty() ? "" : "; ") + row.name + " of " + count(row.faces) + " faces: " + number(row.ratio);
  }
  return text;
}

}  // namespace

void study_one_to_all(const Settings& settings) {
  Report report(settings.folder, "geodesics", "one-to-all", "One source to every vertex, beside CGAL");
  Tables tables;
  std::vector<Row> rows;
  for (const BenchMesh& mesh : one_to_all_meshes(settings)) rows.push_back(measure(mesh, tables, settings));
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.ratio < b.ratio; });
  std::vector<Row> many, slow;
  for (const Row& row : rows) {
    if (row.many_windows) many.push_back(row);
    if (row.ratio < 20) slow.push_back(row);
  }
  report.target("One to all: CGAL's time over ours, on every mesh", "at least 20",
                slow.empty() ? "least: " + measured({rows.front()}) : "below 20: " + measured(slow), slow.empty());
  report.target("One to all where windows are many", "at least 35", measured(many), many.front().ratio >= 35);
  report.table(tables.fields);
  report.image("geodesics-ratio.svg", "CGAL's time over ours, against the number of faces");
  report.heading("Kept fields");
  report.text(
      "A field that keeps its windows answers for any point of the surface. *Bytes per face* is the memory of the kept "
      "field; queries go to random points.");
  report.table(tables.kept);
  report.write("bench_geodesics one-to-all", settings.brief,
               "A source at a random place, another one in each repetition. *CGAL* is the time of "
               "`build_sequence_tree`; our time includes the distances at all vertices, CGAL's would need a query for "
               "each. *Windows* counts those that the search made, dropped ones included.");
}

}  // namespace supple::bench
