// Geodesic Voronoi diagrams: accuracy against time, peers, scaling, sites that move, optimized sites. Each study writes
// a section of voronoi.md and its CSV files; plot.py draws the figure.
//
//   voronoi_bench [--short] [--out DIR] [STUDY ...]      default: all studies into docs/bench
#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "command_line.h"
#include "measurement.h"
#include "report.h"
#include "supple/base/threads.h"
#include "supple/surface/moving_points.h"
#include "supple/voronoi/moving_diagram.h"
#include "supple/voronoi/optimization.h"
#include "support/cgal_geodesics.h"
#include "support/shapes.h"

namespace supple::voronoi {
namespace {

using bench::count;
using bench::number;
using surface::GeodesicSolver;
using surface::TriangleMesh;

struct Settings {
  bool brief = false;
  std::filesystem::path folder = "docs/bench";
};

/// A row of the thesis's Table 3.4, with a mesh of ours of about the same size.
struct Row {
  std::string shape;
  TriangleMesh mesh;
  int sites;
  std::string objective;
  double thesis_seconds;
  int iterations;
};

std::vector<Row> rows(bool brief) {
  const auto its = [&](int usual) { return brief ? 2 : usual; };
  std::vector<Row> all;
  all.push_back({"sphere", testing::icosphere(3), 98, "edge_length", 1.90, its(200)});
  all.push_back({"rabbit (duck)", testing::rabbit(3), 125, "edge_length", 4.39, its(200)});
  all.push_back({"genus 3 (cactus)", testing::genus3(4), 107, "edge_length", 4.03, its(200)});
  all.push_back({"sphere", testing::icosphere(3), 396, "planarity", 0.474, its(1000)});
  all.push_back({"torus", testing::torus(24, 12), 155, "planarity", 0.0733, its(1000)});
  all.push_back({"rabbit (duck)", testing::rabbit(3), 487, "planarity", 1.17, its(1000)});
  if (brief) return all;
  all.push_back({"genus 3 (fertility)", testing::genus3(4), 2250, "regularity", 7.09, 60});
  all.push_back({"rabbit (cow)", testing::rabbit(5), 2928, "regularity", 39.3, 60});
  all.push_back({"rabbit (armadillo)", testing::rabbit(10), 10000, "regularity", 180, 30});
  return all;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double& weight_of(ObjectiveWeights& weights, const std::string& objective) {
  if (objective == "edge_length") return weights.edge_length;
  if (objective == "planarity") return weights.planarity;
  return objective == "regularity" ? weights.regularity : weights.equal_area;
}

/// Least wall seconds of a diagram over some repetitions.
double diagram_seconds(const GeodesicSolver& solver, const std::vector<surface::SurfacePoint>& sites,
                       const DiagramOptions& options, int repetitions) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    bench::keep(diagram(solver, sites, options).cells[0].area);
    best = std::min(best, seconds_since(start));
  }
  return best;
}

/// Adds the polygons into which the borders cut the surface, for the figure: a row for each corner.
void draw(const TriangleMesh& mesh, const std::string& scene, const std::string& state, const Diagram& diagram,
          bench::Table& table) {
  int polygon = 0;
  const auto add = [&](std::int32_t site, const std::vector<Eigen::Vector3d>& corners) {
    for (const Eigen::Vector3d& p : corners)
      table.row({scene, state, std::to_string(polygon), std::to_string(site), number(p.x(), 5), number(p.y(), 5),
                 number(p.z(), 5)});
    ++polygon;
  };
  for (std::int32_t face = 0; face < mesh.face_count(); ++face) {
    const std::int32_t site = diagram.face_sites[static_cast<std::size_t>(face)];
    if (site < 0) continue;
    std::vector<Eigen::Vector3d> corners;
    for (const std::int32_t v : mesh.faces()[static_cast<std::size_t>(face)])
      corners.push_back(mesh.positions()[static_cast<std::size_t>(v)]);
    add(site, corners);
  }
  for (const DiagramPiece& piece : diagram.pieces) {
    std::vector<Eigen::Vector3d> corners;
    for (std::int32_t k = 0; k < piece.corner_count; ++k)
      corners.push_back(
          position(mesh, {FaceId(piece.face), diagram.corners[static_cast<std::size_t>(piece.first_corner + k)]}));
    add(piece.site, corners);
  }
}

void study_designs(const Settings& settings) {
  bench::Report report(settings.folder, "voronoi", "designs", "Optimized sites, before and after");
  bench::Table table("voronoi-designs", {{"shape", "Mesh (theirs)"},
                                         {"faces", "Faces"},
                                         {"sites", "Sites"},
                                         {"objective", "Objective"},
                                         {"measure", "Measure"},
                                         {"before", "Mean before"},
                                         {"after", "after"},
                                         {"worst_before", "Greatest before"},
                                         {"worst_after", "after"},
                                         {"spread_before", "Deviation before"},
                                         {"spread_after", "after"},
                                         {"iterations", "Iterations"},
                                         {"stopped", "Ended"}});
  bench::Table times("voronoi-iterations", {{"shape", "Mesh (theirs)"},
                                            {"faces", "Faces"},
                                            {"sites", "Sites"},
                                            {"objective", "Objective"},
                                            {"diagram", "A diagram (ms)"},
                                            {"iteration", "An iteration (ms)"},
                                            {"thesis", "Thesis, 64 cores (ms)"},
                                            {"ratio", "Ratio"}});
  bench::Table polygons("voronoi-figure", {{"scene", "Scene"},
                                           {"state", "State"},
                                           {"polygon", "Polygon"},
                                           {"site", "Site"},
                                           {"x", "x"},
                                           {"y", "y"},
                                           {"z", "z"}});
  for (Row& row : rows(settings.brief)) {
    const GeodesicSolver solver(testing::share(row.mesh));
    const std::vector<surface::SurfacePoint> sites = random_sites(row.mesh, row.sites, 1);
    OptimizationOptions options;
    options.method = OptimizationMethod::lbfgs;
    options.max_iterations = row.iterations;
    weight_of(options.weights, row.objective) = 1;
    const double alone = diagram_seconds(solver, sites, {}, settings.brief ? 1 : 5);
    const auto start = std::chrono::steady_clock::now();
    const Optimization found = optimize(solver, sites, options);
    const double seconds = seconds_since(start) / std::max(1, found.iterations);
    const auto& [measure, before, after] =
        row.objective == "edge_length" ? std::tuple("edge length", found.before.edge_length, found.after.edge_length)
        : row.objective == "planarity"
            ? std::tuple("distance from the plane", found.before.planarity, found.after.planarity)
            : std::tuple("vertex distance over the cell's mean", found.before.vertex_distance,
                         found.after.vertex_distance);
    table.row({row.shape, count(row.mesh.face_count()), count(row.sites), row.objective, measure, number(before.mean),
               number(after.mean), number(before.greatest), number(after.greatest), number(before.deviation),
               number(after.deviation), std::to_string(found.iterations), std::string(to_string(found.stopped))});
    times.row({row.shape, count(row.mesh.face_count()), count(row.sites), row.objective, number(1e3 * alone),
               number(1e3 * seconds), number(1e3 * row.thesis_seconds), number(row.thesis_seconds / seconds)});
    if (row.sites < 500) {
      const std::string scene = row.shape.substr(0, row.shape.find(" (")) + ", " + row.objective;
      draw(row.mesh, scene, "before", diagram(solver, sites), polygons);
      draw(row.mesh, scene, "after", found.diagram, polygons);
    }
  }
  report.table(table);
  report.data(polygons);
  report.image("voronoi-figure.png", "Cells before and after, of the rows with fewer than 500 sites.");
  report.heading("Time of an iteration");
  report.text(
      "Wall time of a whole optimization over its iterations: diagrams of all trial states, derivatives, step. "
      "The thesis's times (Table 3.4) are of 64 cores.");
  report.table(times);
  report.write(
      "voronoi_bench designs", settings.brief,
      "From random sites, by L-BFGS. The thesis's figures 3.8 to 3.10 show the same objectives on meshes of the "
      "same sizes; theirs are in brackets. The target length is the mean at the start.");
}

/// Mean wall seconds of diagrams after moves of `moved` sites by a tenth of the mean cell size: recomputed around these
/// sites, and as a whole.
struct RebuildSeconds {
  double local = 0;
  double whole = 0;
  double cut_faces = 0;
};
RebuildSeconds rebuild_seconds(const GeodesicSolver& solver, int count_of_sites, int moved, int repetitions) {
  const TriangleMesh& mesh = solver.mesh();
  surface::MovingPoints points(mesh, random_sites(mesh, count_of_sites, 1));
  MovingDiagram moving(solver);
  double area = 0;
  for (const DiagramCell& cell : moving.move_to(points.points()).cells) area += cell.area;
  const double distance = 0.1 * std::sqrt(area / count_of_sites);
  RebuildSeconds result;
  for (int i = 0; i < repetitions; ++i) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(points.dimension());
    for (int k = 0; k < moved; ++k) {
      const Eigen::Index site = (37 * i + k * (count_of_sites / moved)) % count_of_sites;
      step[2 * site] = distance;
    }
    points.move(mesh, step);
    auto start = std::chrono::steady_clock::now();
    bench::keep(moving.move_to(points.points()).cells[0].area);
    result.local += seconds_since(start) / repetitions;
    result.cut_faces += static_cast<double>(moving.last_rebuild().cut_faces) / repetitions;
    start = std::chrono::steady_clock::now();
    bench::keep(diagram(solver, points.points()).cells[0].area);
    result.whole += seconds_since(start) / repetitions;
  }
  return result;
}

void study_moves(const Settings& settings) {
  bench::Report report(settings.folder, "voronoi", "moves", "One site moves");
  bench::Table table("voronoi-moves", {{"shape", "Mesh"},
                                       {"faces", "Faces"},
                                       {"sites", "Sites"},
                                       {"cut", "Faces cut again, one site moved"},
                                       {"whole", "Whole diagram (ms)"},
                                       {"local", "Only round the site (ms)"},
                                       {"ratio", "Ratio"},
                                       {"local_many", "1 of 16 sites moved (ms)"},
                                       {"ratio_many", "Ratio"}});
  for (const Row& row : rows(settings.brief)) {
    const GeodesicSolver solver(testing::share(row.mesh));
    const RebuildSeconds one = rebuild_seconds(solver, row.sites, 1, settings.brief ? 2 : 20);
    const RebuildSeconds many = rebuild_seconds(solver, row.sites, row.sites / 16, settings.brief ? 1 : 5);
    table.row({row.shape, count(row.mesh.face_count()), count(row.sites), number(one.cut_faces),
               number(1e3 * one.whole), number(1e3 * one.local), number(one.whole / one.local),
               number(1e3 * many.local), number(many.whole / many.local)});
  }
  report.table(table);
  report.write(
      "voronoi_bench moves", settings.brief,
      "A site moves by a tenth of the mean cell size, and the diagram is made anew only where that changes it, or as a "
      "whole; the results are the same but for rounding. Putting the diagram together, which takes all of it, is most "
      "of what is left where sites are many. Up to an eighth of the sites may move at once; beyond, the whole is "
      "made.");
}

void study_scaling(const Settings& settings) {
  bench::Report report(settings.folder, "voronoi", "scaling", "Scaling");
  bench::Table table("voronoi-scaling", {{"faces", "Faces"},
                                         {"sites", "Sites"},
                                         {"propagation", "One propagation (ms)"},
                                         {"diagram", "Diagram (ms)"},
                                         {"one_thread", "on one thread (ms)"},
                                         {"cut", "Cut faces"}});
  const int threads = thread_count();
  for (const int n : settings.brief ? std::vector<int>{3} : std::vector<int>{3, 5, 10, 15, 20}) {
    const TriangleMesh mesh = testing::rabbit(n);
    const GeodesicSolver solver(testing::share(mesh));
    for (const int share : {1000, 100, 10, 2}) {
      const int sites_wanted = std::max(1, mesh.face_count() / share);
      const std::vector<surface::SurfacePoint> sites = random_sites(mesh, sites_wanted, 1);
      CostLedger cost;
      diagram(solver, sites, {}, {.cost = &cost});
      double propagation = std::numeric_limits<double>::infinity();
      for (int i = 0; i < 3; ++i) {
        const auto start = std::chrono::steady_clock::now();
        bench::keep(solver.field({sites.data(), 1}).vertex_distances()[0]);
        propagation = std::min(propagation, seconds_since(start));
      }
      const double both = diagram_seconds(solver, sites, {}, 3);
      set_thread_count(1);
      const double one = diagram_seconds(solver, sites, {}, 3);
      set_thread_count(threads);
      double cut_faces = 0;
      for (const auto& quantity : cost.quantities())
        if (quantity.name == "cut_faces") cut_faces = quantity.value;
      table.row({count(mesh.face_count()), count(sites_wanted), number(1e3 * propagation), number(1e3 * both),
                 number(1e3 * one), count(cut_faces)});
    }
  }
  report.table(table);
  report.write(
      "voronoi_bench scaling", settings.brief,
      "A rabbit of growing resolution. One propagation is that of a distance field from one site over the whole "
      "mesh, without anything kept.");
}

/// Greatest difference of the distances of a diagram's points from their two sites, each found by a search. About
/// `max_edges` edges are examined at most.
double equidistance_of(const GeodesicSolver& solver, const Diagram& diagram, std::size_t max_edges) {
  double worst = 0;
  std::size_t step = std::max<std::size_t>(1, diagram.edges.size() / max_edges);
  for (std::size_t e = 0; e < diagram.edges.size(); e += step) {
    const DiagramEdge& edge = diagram.edges[e];
    const surface::SurfacePoint& point =
        diagram.points[static_cast<std::size_t>(edge.points[edge.points.size() / 2])].point;
    const auto distance = [&](int side) {
      return solver.distance(diagram.sites[static_cast<std::size_t>(edge.sites[static_cast<std::size_t>(side)])],
                             point);
    };
    worst = std::max(worst, std::abs(distance(0) - distance(1)));
  }
  return worst;
}

double area_error(const Diagram& diagram, const Diagram& exact) {
  double wrong = 0;
  double total = 0;
  for (std::size_t i = 0; i < exact.cells.size(); ++i) {
    wrong += std::abs(diagram.cells[i].area - exact.cells[i].area);
    total += exact.cells[i].area;
  }
  return wrong / total;
}

void study_accuracy(const Settings& settings) {
  bench::Report report(settings.folder, "voronoi", "accuracy", "Error against time");
  bench::Table table("voronoi-accuracy", {{"shape", "Mesh"},
                                          {"faces", "Faces"},
                                          {"sites", "Sites"},
                                          {"method", "Method"},
                                          {"ms", "ms"},
                                          {"equidistance", "Distances differ by at most (of the diagonal)"},
                                          {"area", "Area in another cell (%)"}});
  std::vector<std::tuple<std::string, TriangleMesh, int>> scenes{
      {"rabbit", testing::rabbit(settings.brief ? 2 : 8), 60}};
  if (!settings.brief) {
    scenes.emplace_back("bumpy cube", testing::bumpy_cube(), 60);
    scenes.emplace_back("sphere", testing::icosphere(4), 2000);
  }
  for (const auto& [name, mesh, wanted] : scenes) {
    const GeodesicSolver solver(testing::share(mesh));
    const std::vector<surface::SurfacePoint> sites = random_sites(mesh, wanted, 1);
    const Diagram exact = diagram(solver, sites);
    struct Choice {
      std::string name;
      DiagramOptions options;
    };
    std::vector<Choice> choices{{"exact", {}}};
    for (const double error : {1e-4, 1e-3, 1e-2, 1e-1})
      choices.push_back(
          {"within " + number(100 * error) + " %", {.method = DiagramMethod::bounded, .relative_error = error}});
    choices.push_back({"along edges", {.method = DiagramMethod::edges}});
    for (const Choice& choice : choices) {
      const Diagram found = diagram(solver, sites, choice.options);
      table.row({name, count(mesh.face_count()), count(wanted), choice.name,
                 number(1e3 * diagram_seconds(solver, sites, choice.options, 3)),
                 number(equidistance_of(solver, found, 500) / mesh.diagonal(), 2),
                 number(100 * area_error(found, exact), 2)});
    }
  }
  report.table(table);
  report.write(
      "voronoi_bench accuracy", settings.brief,
      "Distances of the middle points of edges from their two sites, by a search for each pair, and the areas of "
      "cells against those of the exact diagram. Allowed errors save no time here: windows of several sites end where "
      "they meet anyway, and inexact ones overlap more.");
}

void study_peers(const Settings& settings) {
  bench::Report report(settings.folder, "voronoi", "peers", "Peers");
  bench::Table table("voronoi-peers", {{"shape", "Mesh"},
                                       {"faces", "Faces"},
                                       {"sites", "Sites"},
                                       {"own", "Ours (ms)"},
                                       {"cgal", "CGAL, a tree for each site (ms)"},
                                       {"ratio", "Ratio"},
                                       {"agree", "Vertices with the same site (%)"},
                                       {"difference", "Largest difference of distances"},
                                       {"euclidean", "Nearest in space (ms)"},
                                       {"wrong", "Vertices that it gives to a wrong cell (%)"}});
  std::vector<std::tuple<std::string, TriangleMesh, int>> scenes{{"sphere", testing::icosphere(3), 60}};
  if (!settings.brief) {
    scenes.emplace_back("torus", testing::torus(48, 24), 60);
    scenes.emplace_back("rabbit", testing::rabbit(5), 40);
    scenes.emplace_back("spiral cup", testing::spiral_cup(), 20);
  }
  for (const auto& [name, mesh, wanted] : scenes) {
    const GeodesicSolver solver(testing::share(mesh));
    const std::vector<surface::SurfacePoint> sites = random_sites(mesh, wanted, 1);
    const double own = diagram_seconds(solver, sites, {}, 3);
    const Diagram found = diagram(solver, sites);
    const auto vertices = static_cast<std::size_t>(mesh.vertex_count());
    std::vector<double> least(vertices, std::numeric_limits<double>::infinity());
    std::vector<std::int32_t> nearest(vertices, -1);
    auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < sites.size(); ++i) {
      testing::CgalGeodesics cgal(mesh);
      cgal.set_source(sites[i]);
      cgal.search();
      const std::vector<double> distances = cgal.vertex_distances();
      for (std::size_t v = 0; v < vertices; ++v) {
        if (!(distances[v] < least[v])) continue;
        least[v] = distances[v];
        nearest[v] = static_cast<std::int32_t>(i);
      }
    }
    const double cgal_seconds = seconds_since(start);
    const std::vector<double> own_distances = solver.field(sites).vertex_distances();
    double same = 0;
    double difference = 0;
    for (std::size_t v = 0; v < vertices; ++v) {
      same += found.vertex_sites[v] == nearest[v] ? 1 : 0;
      difference = std::max(difference, std::abs(own_distances[v] - least[v]));
    }
    start = std::chrono::steady_clock::now();
    double wrong = 0;
    for (std::size_t v = 0; v < vertices; ++v) {
      std::int32_t best = 0;
      double shortest = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < sites.size(); ++i) {
        const double distance = (position(mesh, sites[i]) - mesh.positions()[v]).squaredNorm();
        if (!(distance < shortest)) continue;
        shortest = distance;
        best = static_cast<std::int32_t>(i);
      }
      wrong += best != found.vertex_sites[v] ? 1 : 0;
    }
    const double euclidean = seconds_since(start);
    const auto percent = [&](double part) { return number(100 * part / static_cast<double>(vertices)); };
    table.row({name, count(mesh.face_count()), count(wanted), number(1e3 * own), number(1e3 * cgal_seconds),
               number(cgal_seconds / own), percent(same), number(difference, 2), number(1e3 * euclidean),
               percent(wrong)});
  }
  report.table(table);
  report.write(
      "voronoi_bench peers", settings.brief,
      "CGAL's Surface_mesh_shortest_path builds an exact search tree for each site; only the nearest site of each "
      "vertex is taken from it, not the cells. The restricted Euclidean diagram takes the nearest site in space, "
      "by all pairs: it is wrong where the surface bends back on itself.");
}

}  // namespace
}  // namespace supple::voronoi

int main(int argc, char** argv) {
  using namespace supple::voronoi;
  Settings settings;
  return supple::bench::run_program(
      argc, argv,
      {supple::bench::flag("--short", settings.brief), supple::bench::folder_option("--out", settings.folder)},
      {{"accuracy", [&] { study_accuracy(settings); }},
       {"peers", [&] { study_peers(settings); }},
       {"scaling", [&] { study_scaling(settings); }},
       {"moves", [&] { study_moves(settings); }},
       {"designs", [&] { study_designs(settings); }}});
}
