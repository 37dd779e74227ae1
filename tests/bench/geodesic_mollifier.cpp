// The mollifier: what a smoothing length costs in accuracy and time, on the crossings of edges alone and on the ends
// too; and what is left of the Hessian's jump where a hyperbolic vertex begins to hold a path.
#include <algorithm>
#include <cmath>

#include "geodesic_bench.h"
#include "measurement.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using surface::Geodesic;
using surface::GeodesicSolver;
using surface::SurfacePoint;

struct MollifierErrors {
  int touched = 0;  ///< pairs whose length the mollifier changed
  double length = 0, gradient = 0, hessian = 0;
  double microseconds = 0;
};

/// Against the exact derivatives: lengths in mean edges, gradients (of unit vectors) absolute, Hessians relative; the
/// largest.
MollifierErrors errors_of(const GeodesicSolver& solver, const std::vector<PointPair>& pairs, double epsilon,
                          bool ends) {
  std::vector<Geodesic> exact, mollified;
  for (const auto& [from, to] : pairs) exact.push_back(solver.geodesic(from, to, {.derivatives = 2}));
  MollifierErrors errors;
  const double seconds = cpu_time([&] {
    for (const auto& [from, to] : pairs) {
      mollified.push_back(solver.geodesic(from, to, {.derivatives = 2, .mollifier = epsilon, .mollified_ends = ends}));
    }
  });
  errors.microseconds = 1e6 * seconds / static_cast<double>(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double length = mollified[i].mollified_distance.value_or(exact[i].distance);
    const double off = std::abs(length - exact[i].distance) / solver.mesh().mean_edge_length();
    errors.touched += off > 1e-12;
    errors.length = std::max(errors.length, off);
    errors.gradient = std::max(
        errors.gradient, (mollified[i].derivatives->tangent_gradient - exact[i].derivatives->tangent_gradient).norm());
    errors.hessian = std::max(
        errors.hessian, (mollified[i].derivatives->tangent_hessian - exact[i].derivatives->tangent_hessian).norm() /
                            exact[i].derivatives->tangent_hessian.norm());
  }
  return errors;
}

/// The second end moves into the shadow of a saddle vertex: the largest entry by which the Hessian jumps there.
double jump_of_hessian(double start, double epsilon) {
  const auto mesh = testing::share(testing::cone(4, 8.5));
  const GeodesicSolver solver(mesh);
  const auto at = [&](double angle, double r) {
    std::int32_t h = mesh->outgoing(0);
    for (; angle > mesh->corner_angle(h); h = mesh->rotate(h)) angle -= mesh->corner_angle(h);
    const double whole = mesh->corner_angle(h);
    SurfacePoint point{FaceId(surface::TriangleMesh::face_of(h)), Eigen::Vector3d::Zero()};
    point.barycentric[(h + 1) % 3] = r * std::sin(whole - angle) / std::sin(whole);
    point.barycentric[(h + 2) % 3] = r * std::sin(angle) / std::sin(whole);
    point.barycentric[h % 3] = 1 - point.barycentric.sum();
    return point;
  };
  Eigen::Matrix4d hessians[2];
  for (int side = 0; side < 2; ++side) {
    const double beyond = (side == 0 ? -1e-6 : 1e-6) * (epsilon > 0 ? epsilon : 1);
    hessians[side] =
        solver.geodesic(at(start, 0.4), at(start + M_PI + beyond, 0.5), {.derivatives = 2, .mollifier = epsilon})
            .derivatives->tangent_hessian;
  }
  return (hessians[1] - hessians[0]).cwiseAbs().maxCoeff();
}

}  // namespace

void measure_mollifier(Report& report, const Settings& settings) {
  report.heading("Error against smoothing length");
  report.text(
      "Random pairs of points and, in the second half, pairs whose first end lies within 1e-3 of an edge (a "
      "barycentric "
      "coordinate drawn between 0 and 1e-3), as networks have them that are set up along edges. Crossings and ends are "
      "mollified with smoothing length *e*. Pairs: those whose length changes. Errors are the largest, of the length "
      "in mean edges, of the gradient as the length of the difference (an exact one is two unit vectors), of the "
      "Hessian "
      "relative. Without a mollifier the time is that of the row with *e* = 0.");
  Table table("geodesics-mollifier", {{"mesh", "Mesh"},
                                      {"ends", "Pairs of points"},
                                      {"mollified", "Mollified"},
                                      {"epsilon", "e"},
                                      {"pairs", "Pairs"},
                                      {"touched", "Changed"},
                                      {"length_error", "Length"},
                                      {"gradient_error", "Gradient"},
                                      {"hessian_error", "Hessian"},
                                      {"microseconds", "us per pair"}});
  const int n = settings.brief ? 20 : 1000;
  std::vector<BenchMesh> meshes = {{"saddle", [] { return testing::saddle(24); }, false},
                                   {"torus", [] { return testing::torus(); }, false},
                                   {"bumpy cube", [] { return testing::bumpy_cube(16, 1.5, 0.02); }, false}};
  if (settings.brief) meshes.resize(1);
  double worst_crossing_length = 0;
  for (const BenchMesh& kind : meshes) {
    const auto mesh = make_shared_mesh(kind);
    const GeodesicSolver solver(mesh);
    for (const bool beside_edges : {false, true}) {
      auto pairs = near_pairs(*mesh, n, 4, 91);
      RandomStream stream("mollifier", 92);
      for (auto& [from, to] : pairs) {
        if (!beside_edges) continue;
        const int corner = static_cast<int>(3 * stream.uniform());
        const double rest = 1 - from.barycentric[corner];
        const double w = 1e-3 * stream.uniform();
        for (int i = 0; i < 3; ++i) from.barycentric[i] *= (1 - w) / rest;
        from.barycentric[corner] = w;
        from = surface::checked_point(*mesh, from);
      }
      for (const bool ends : {false, true}) {
        for (const double epsilon : {0., 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1}) {
          if (ends && epsilon == 0) continue;
          const MollifierErrors e = errors_of(solver, pairs, epsilon, ends);
          if (!ends) worst_crossing_length = std::max(worst_crossing_length, epsilon > 0 ? e.length / epsilon : 0);
          table.row({kind.name, beside_edges ? "beside edges" : "anywhere", ends ? "crossings and ends" : "crossings",
                     number(epsilon), std::to_string(n), std::to_string(e.touched), number(e.length, 2),
                     number(e.gradient, 2), number(e.hessian, 2), number(e.microseconds, 3)});
        }
      }
    }
  }
  report.table(table);
  report.text(
      "*What this says.* Mollified crossings change few pairs while *e* is small, and their lengths by less than " +
      number(worst_crossing_length, 2) +
      " *e* mean edges; but where they do, the gradient's error does not shrink with *e*, only the "
      "share of the paths that have it, and from *e* = 0.01 on it exceeds the gradient: *e* is to be small. "
      "Mollified ends change the gradient of a pair beside an edge by as much as the gradient is long, at any "
      "*e* above the distance from the edge: on the edge itself nothing pulls the end off it any more, and where a "
      "coordinate passes *e* the Hessian jumps by 2 / *e* times the gradient. A minimizer would take every edge for an "
      "equilibrium, which no exact length does: in unfolded faces a length is as smooth across an edge as inside a "
      "face. This is why ends are mollified only where that is asked for (`mollified_ends`).");

  report.heading("The Hessian's jump at a hyperbolic vertex");
  report.text(
      "The second end moves into the shadow of a vertex of total angle 8.5: from there on the vertex holds the path. "
      "Largest entry of the jump of the Hessian (1 / mesh unit), between positions an angle of 1e-6 *e* on either "
      "side. With one "
      "edge of the vertex crossed before, the mollifier removes the jump. With two it does not: each crossing is "
      "mollified by its own *t*, the crossings leave the line that they lie on, and a bend of fixed angle remains "
      "between them, whose curvature grows as 1 / *e*.");
  Table jumps("geodesics-mollifier-jumps", {{"epsilon", "e"}, {"one_edge", "One edge"}, {"two_edges", "Two edges"}});
  for (const double epsilon : {0., 1e-4, 1e-3, 1e-2, 1e-1}) {
    jumps.row({number(epsilon), number(jump_of_hessian(0.6, epsilon), 2), number(jump_of_hessian(1.3, epsilon), 2)});
  }
  report.table(jumps);
}

}  // namespace supple::bench
