#include "supple/voronoi/moving_diagram.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagram_faces.h"
#include "planar_face.h"
#include "site_places.h"
#include "supple/base/error.h"
#include "supple/surface/geodesic_field.h"

namespace supple::voronoi {
namespace {

using surface::FieldOptions;
using surface::GeodesicField;
using surface::SurfacePoint;
using surface::TriangleMesh;

/// Where more than this share of the sites has moved, a whole diagram takes less time (measured by voronoi_bench).
constexpr double max_moved = 0.125;

bool same_point(const SurfacePoint& a, const SurfacePoint& b) {
  return a.face == b.face && a.barycentric == b.barycentric;
}

}  // namespace

struct MovingDiagram::Implementation {
  Implementation(const surface::GeodesicSolver& own_solver, const DiagramOptions& own_options)
      : solver(own_solver), options(own_options), faces(own_solver.mesh(), own_options) {}

  const TriangleMesh& mesh() const { return solver.mesh(); }

  std::size_t most_to_move() const {
    return std::max<std::size_t>(1, static_cast<std::size_t>(max_moved * static_cast<double>(sites.size())));
  }

  bool is_near(std::span<const SurfacePoint> others) const {
    if (!kept || options.method != DiagramMethod::exact || others.size() != sites.size()) return false;
    std::size_t moved = 0;
    for (std::size_t i = 0; i < sites.size(); ++i)
      if (!same_point(sites[i], others[i]) && ++moved > most_to_move()) return false;
    return true;
  }

  GeodesicField field(const std::vector<SurfacePoint>& sources, const std::vector<double>& known,
                      const Execution& execution) const {
    FieldOptions field_options;
    field_options.keep_windows = options.method != DiagramMethod::edges;
    if (options.method == DiagramMethod::edges) field_options.method = surface::FieldMethod::edge_graph;
    if (options.method == DiagramMethod::bounded) field_options.relative_error = options.relative_error;
    field_options.known_distances = known;
    Execution own = execution;
    own.cost = nullptr;
    GeodesicField result = solver.field(sources, field_options, own);
    if (execution.cost != nullptr) execution.cost->add_quantity("windows", static_cast<double>(result.window_count()));
    return result;
  }

  void rebuild_all(const Execution& execution) {
    std::vector<SurfacePoint> sources;
    std::vector<std::int32_t> site_of_source;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (!has_cell(i)) continue;
      sources.push_back(sites[i]);
      site_of_source.push_back(static_cast<std::int32_t>(i));
    }
    const GeodesicField all = [&] {
      const StageTimer timer(execution.cost, "propagation");
      return field(sources, {}, execution);
    }();
    const StageTimer timer(execution.cost, "cells");
    faces.cut_all({all, site_of_source, sites}, execution);
    last = {false, static_cast<std::int32_t>(sites.size()), mesh().face_count()};
  }

  using Flags = std::vector<std::uint8_t>;

  static bool flagged(const Flags& flags, std::int32_t index) {
    return index >= 0 && flags[static_cast<std::size_t>(index)] != 0;
  }

  /// The faces that a cell of `left`, whose sites were at `before`, has a part of. A cell is connected: from the face
  /// of its site on, as long as faces that share a corner have a part of it.
  void mark_cells(const std::vector<SurfacePoint>& before, const Flags& left, Flags& marked) const {
    std::vector<std::int32_t> front;
    for (std::size_t i = 0; i < before.size(); ++i)
      if (left[i] != 0) front.push_back(index(before[i].face));
    Flags seen(marked.size(), 0);
    for (const std::int32_t face : front) seen[static_cast<std::size_t>(face)] = 1;
    const std::size_t of_sites = front.size();
    for (std::size_t next = 0; next < front.size(); ++next) {
      const std::int32_t face = front[next];
      bool has_part = next < of_sites;
      faces.visit_sites(face, [&](std::int32_t site) { has_part = has_part || flagged(left, site); });
      if (!has_part) continue;
      marked[static_cast<std::size_t>(face)] = 1;
      for (const std::int32_t v : mesh().faces()[static_cast<std::size_t>(face)]) {
        const std::int32_t start = mesh().outgoing(v);
        std::int32_t h = start;
        do {
          std::uint8_t& known = seen[static_cast<std::size_t>(TriangleMesh::face_of(h))];
          if (known == 0) front.push_back(TriangleMesh::face_of(h));
          known = 1;
          h = mesh().rotate(h);
        } while (h >= 0 && h != start);
      }
    }
  }

  /// The faces that cells of the sources of a field of known distances may have a part of.
  void mark_reached(const GeodesicField& reaching, std::size_t sources, Flags& marked,
                    const CancellationToken& cancellation) const {
    FaceDistances distances(cancellation);
    Active active;
    Active kept_arrivals;
    for (std::int32_t face = 0; face < mesh().face_count(); ++face) {
      if (marked[static_cast<std::size_t>(face)] != 0 || !reaching.reaches(FaceId(face))) continue;
      reaching.arrivals(FaceId(face), distances.arrivals());
      const std::array<Eigen::Vector2d, 3> corners = planar_corners(mesh(), face);
      const Eigen::Vector2d centre = (corners[0] + corners[1] + corners[2]) / 3;
      double radius = 0;
      for (const Eigen::Vector2d& corner : corners) radius = std::max(radius, (corner - centre).norm());
      distances.all(active);
      distances.prune(active, centre, radius, kept_arrivals);
      for (const std::int32_t i : kept_arrivals)
        if (static_cast<std::size_t>(distances.arrivals()[static_cast<std::size_t>(i)].source) < sources)
          marked[static_cast<std::size_t>(face)] = 1;
    }
  }

  /// Makes the distances of vertices unknown (infinite) whose site is one of these.
  void forget(const Flags& of_sites, std::vector<double>& known) const {
    for (std::size_t v = 0; v < known.size(); ++v)
      if (flagged(of_sites, faces.vertex_sites()[v])) known[v] = std::numeric_limits<double>::infinity();
  }

  /// `left` flags sites whose cells are no more what they were, `come` those that have others now. False where no site
  /// is left that can take over, and nothing is changed.
  bool rebuild_near(const std::vector<SurfacePoint>& before, const Flags& left, const Flags& come,
                    const Execution& execution) {
    std::vector<std::int32_t> again;
    std::vector<std::int32_t> site_of_source;
    Flags changed = left;
    std::optional<GeodesicField> around;
    {
      const StageTimer timer(execution.cost, "propagation");
      Flags marked(static_cast<std::size_t>(mesh().face_count()), 0);
      mark_cells(before, left, marked);
      std::vector<SurfacePoint> sources;
      for (std::size_t i = 0; i < sites.size(); ++i) {
        if (come[i] == 0) continue;
        changed[i] = 1;
        sources.push_back(sites[i]);
      }
      std::vector<double> known = faces.vertex_distances();
      forget(left, known);
      if (!sources.empty())
        mark_reached(field(sources, known, execution), sources.size(), marked, execution.cancellation);
      Flags near = come;
      for (std::int32_t face = 0; face < mesh().face_count(); ++face) {
        if (marked[static_cast<std::size_t>(face)] == 0) continue;
        again.push_back(face);
        faces.visit_sites(face, [&](std::int32_t site) { near[static_cast<std::size_t>(site)] = 1; });
      }
      forget(near, known);
      sources.clear();
      for (std::size_t i = 0; i < sites.size(); ++i) {
        if (near[i] == 0 || !has_cell(i)) continue;
        sources.push_back(sites[i]);
        site_of_source.push_back(static_cast<std::int32_t>(i));
      }
      if (sources.empty()) return false;
      around.emplace(field(sources, known, execution));
    }
    const StageTimer timer(execution.cost, "cells");
    faces.cut_again(again, {*around, site_of_source, sites}, changed, execution);
    last = {true, static_cast<std::int32_t>(std::count(changed.begin(), changed.end(), 1)),
            static_cast<std::int32_t>(again.size())};
    return true;
  }

  bool has_cell(std::size_t site) const { return first[site] == static_cast<std::int32_t>(site); }

  const Diagram& move_to(std::span<const SurfacePoint> wanted, const Execution& execution) {
    check(wanted);
    std::vector<SurfacePoint> now = checked(wanted);
    const bool near = is_near(now);
    kept = false;
    const std::vector<SurfacePoint> before = std::exchange(sites, std::move(now));
    const std::vector<std::int32_t> first_before =
        std::exchange(first, first_in_place(mesh(), sites, execution.cancellation));
    if (!near || !rebuild_near_to(before, first_before, execution)) rebuild_all(execution);
    write(execution);
    if (execution.cost != nullptr && last.local) execution.cost->add_quantity("local_rebuilds", 1);
    kept = true;
    return diagram;
  }

  std::vector<SurfacePoint> checked(std::span<const SurfacePoint> points) const {
    std::vector<SurfacePoint> result;
    result.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      result.push_back(surface::checked_point(mesh(), points[i], "sites/" + std::to_string(i)));
    return result;
  }

  /// True where nothing has moved, too.
  bool rebuild_near_to(const std::vector<SurfacePoint>& before, const std::vector<std::int32_t>& first_before,
                       const Execution& execution) {
    Flags left(sites.size(), 0);
    Flags come(sites.size(), 0);
    bool any = false;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const bool had_cell = first_before[i] == static_cast<std::int32_t>(i);
      const bool moved = !same_point(before[i], sites[i]) || had_cell != has_cell(i);
      left[i] = had_cell && moved ? 1 : 0;
      come[i] = has_cell(i) && moved ? 1 : 0;
      any = any || left[i] != 0 || come[i] != 0;
    }
    last = {true, 0, 0};
    return !any || rebuild_near(before, left, come, execution);
  }

  void check(std::span<const SurfacePoint> wanted) const {
    check_site_count(static_cast<std::int64_t>(wanted.size()));
    if (options.method == DiagramMethod::bounded && !(options.relative_error > 0 && options.relative_error <= 1)) {
      throw Error("voronoi.invalid_option", "An option of the diagram is out of its range.",
                  {{"relative_error", "must be above 0 and at most 1"}});
    }
    if (!(options.border_deviation >= least_border_deviation && options.border_deviation <= 1)) {
      throw Error("voronoi.invalid_option", "An option of the diagram is out of its range.",
                  {{"border_deviation", "must be from 1e-7 to 1"}});
    }
  }

  void write(const Execution& execution) {
    diagram = {};
    diagram.sites = sites;
    diagram.cells.resize(sites.size());
    for (std::size_t i = 0; i < sites.size(); ++i)
      if (!has_cell(i))
        diagram.warnings.push_back("Site " + std::to_string(i) + " is in the place of site " +
                                   std::to_string(first[i]) + ", which has the cell.");
    {
      const StageTimer timer(execution.cost, "assembly");
      write_diagram(faces, options, execution, diagram);
    }
    if (diagram.unreached_area > 0)
      diagram.warnings.emplace_back("Some components of the mesh have no site; they belong to no cell.");
  }

  const surface::GeodesicSolver& solver;
  DiagramOptions options;
  DiagramFaces faces;
  std::vector<SurfacePoint> sites;
  std::vector<std::int32_t> first;  ///< of each site the first one in the same place
  Diagram diagram;
  DiagramRebuild last;
  bool kept = false;  ///< whether faces are those of the sites
};

MovingDiagram::MovingDiagram(const surface::GeodesicSolver& solver, const DiagramOptions& options)
    : implementation_(std::make_unique<Implementation>(solver, options)) {}
MovingDiagram::~MovingDiagram() = default;
MovingDiagram::MovingDiagram(MovingDiagram&&) noexcept = default;
MovingDiagram& MovingDiagram::operator=(MovingDiagram&&) noexcept = default;

const Diagram& MovingDiagram::move_to(std::span<const SurfacePoint> sites, const Execution& execution) {
  return implementation_->move_to(sites, execution);
}
const Diagram& MovingDiagram::diagram() const { return implementation_->diagram; }
Diagram MovingDiagram::take_diagram() { return std::exchange(implementation_->diagram, {}); }
const DiagramRebuild& MovingDiagram::last_rebuild() const { return implementation_->last; }
bool MovingDiagram::is_near(std::span<const SurfacePoint> sites) const {
  return implementation_->is_near(implementation_->checked(sites));
}

}  // namespace supple::voronoi
