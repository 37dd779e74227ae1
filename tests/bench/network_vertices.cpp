// A distance and its derivatives along a line across vertices of three kinds (thesis fig. 3.2).
#include <cmath>
#include <numbers>

#include "network_bench.h"
#include "supple/surface/geodesic_solver.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

constexpr double curvature = 0.8;        ///< of the vertices that are not flat, in radians
constexpr double vertex_distance = 0.5;  ///< of the fixed point, and of the line opposite
constexpr double half_way = 0.3;         ///< of the line
constexpr int samples = 600;

}  // namespace

void draw_kinds_of_vertices(Report& report, const NetworkSettings& settings) {
  report.heading("Kinds of vertices");
  report.text(
      "One end of a geodesic stays at distance 0.5 from a vertex, the other runs along a straight line that passes the "
      "vertex on the other side, at distance 0.5 (thesis fig. 3.2); *s* is the way along the line. At a spherical "
      "vertex "
      "(angle 2 pi - 0.8) the path jumps to the other side: g has a ridge. At a flat one nothing happens. A hyperbolic "
      "one (2 pi + 0.8) holds the path for a while: g' is continuous and g'' jumps. The mollifier (0.1 in the picture, "
      "to be "
      "seen; 1e-6 by default) changes g within that share of an edge. It makes g'' neither continuous nor "
      "small: where crossings near the vertex come within its length, g'' passes through values of both signs that "
      "grow "
      "as the mollifier gets shorter.");
  Table curves(
      "networks-vertices",
      {{"kind", "Kind"}, {"mollifier", "Mollifier"}, {"s", "s"}, {"g", "g"}, {"slope", "g'"}, {"curvature", "g''"}});
  Table table("networks-vertices-jumps", {{"kind", "Kind"},
                                          {"mollifier", "Mollifier"},
                                          {"slope", "Largest change of g' between samples"},
                                          {"least", "Least g''"},
                                          {"largest", "Largest g''"}});
  struct Kind {
    const char* name;
    double angle;
  };
  constexpr double turn = 2 * std::numbers::pi;
  for (const Kind& kind :
       {Kind{"spherical", turn - curvature}, Kind{"flat", turn}, Kind{"hyperbolic", turn + curvature}}) {
    const auto mesh = testing::share(testing::cone(cone_sectors, kind.angle));
    const surface::GeodesicSolver solver(mesh);
    // Off the sectors' sides, which then are crossed like any others.
    const double towards = 0.3 * kind.angle / cone_sectors;
    const double opposite = towards + kind.angle / 2;
    const surface::SurfacePoint fixed = cone_point(*mesh, cone_sectors, vertex_distance, towards);
    for (const double mollifier : {0.0, 0.1, 0.02}) {
      double change = 0, before = 0, least = 0, largest = 0;
      const int n = settings.brief ? 40 : samples;
      for (int i = 0; i < n; ++i) {
        const double s = half_way * (2 * (i + 0.5) / n - 1);
        const double angle = opposite + std::atan2(s, vertex_distance);
        const surface::SurfacePoint point = cone_point(*mesh, cone_sectors, std::hypot(vertex_distance, s), angle);
        const Eigen::Vector2d along = cone_tangent(*mesh, cone_sectors, angle, opposite + std::numbers::pi / 2);
        const surface::Geodesic geodesic = solver.geodesic(fixed, point, {.derivatives = 2, .mollifier = mollifier});
        const double g = geodesic.mollified_distance.value_or(geodesic.distance);
        const double slope = geodesic.derivatives->tangent_gradient.tail<2>().dot(along);
        const double bend = along.dot(geodesic.derivatives->tangent_hessian.bottomRightCorner<2, 2>() * along);
        if (i > 0) change = std::max(change, std::abs(slope - before));
        least = i > 0 ? std::min(least, bend) : bend;
        largest = i > 0 ? std::max(largest, bend) : bend;
        before = slope;
        curves.row({kind.name, number(mollifier, 1), number(s, 6), number(g, 10), number(slope, 8), number(bend, 8)});
      }
      table.row({kind.name, number(mollifier, 1), number(change), number(least), number(largest)});
    }
  }
  report.table(table);
  report.data(curves);
  report.image("networks-vertices.svg", "A distance, its slope and its curvature along a line across a vertex");
}

}  // namespace supple::bench
