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

/// If more than this fraction of the sites has moved, a full diagram takes less time (measured by voronoi_bench).
constexpr double max_moved_fraction = 0.125;

bool same_point(const SurfacePoint& a, const SurfacePoint& b) {
  return a.face == b.face && a.barycentric == b.barycentric;
}

}  // namespace

struct MovingDiagram::Implementation {
  Implementation(const surface::GeodesicSolver& own_solver, const DiagramOptions& own_options)
      : solver(own_solver), options(own_options), faces(own_solver.mesh(), own_options) {}

  const TriangleMesh& mesh() const { return solver.mesh(); }

  std::size_t max_moved_sites() const {
    return std::max<std::size_t>(1, static_cast<std::size_t>(max_moved_fraction * static_cast<double>(sites.size())));
  }

  bool is_near(std::span<const SurfacePoint> others) const {
    if (!is_current || options.method != DiagramMethod::exact || others.size() != sites.size()) return false;
    std::size_t moved = 0;
    for (std::size_t i = 0; i < sites.size(); ++i)
      if (!same_point(sites[i], others[i]) && ++moved > max_moved_sites()) return false;
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

  /// Marks the faces in which a cell of `old_cells`, whose sites were at `before`, has a part. Cells are connected: the
  /// search starts at the faces of the sites and goes on where faces share a corner.
  void mark_cells(const std::vector<SurfacePoint>& before, const Flags& old_cells, Flags& marked) const {
    std::vector<std::int32_t> queue;
    for (std::size_t i = 0; i < before.size(); ++i)
      if (old_cells[i] != 0) queue.push_back(index(before[i].face));
    Flags visited(marked.size(), 0);
    for (const std::int32_t face : queue) visited[static_cast<std::size_t>(face)] = 1;
    const std::size_t of_sites = queue.size();
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const std::int32_t face = queue[next];
      bool has_part = next < of_sites;
      faces.visit_sites(face, [&](std::int32_t site) { has_part = has_part || flagged(old_cells, site); });
      if (!has_part) continue;
      marked[static_cast<std::size_t>(face)] = 1;
      for (const std::int32_t v : mesh().faces()[static_cast<std::size_t>(face)]) {
        const std::int32_t start = mesh().outgoing(v);
        std::int32_t h = start;
        do {
          std::uint8_t& flag = visited[static_cast<std::size_t>(TriangleMesh::face_of(h))];
          if (flag == 0) queue.push_back(TriangleMesh::face_of(h));
          flag = 1;
          h = mesh().rotate(h);
        } while (h >= 0 && h != start);
      }
    }
  }

  /// Marks the faces in which cells of the sources of `reaching`, a field of known distances, may have a part.
  void mark_reached(const GeodesicField& reaching, std::size_t sources, Flags& marked,
                    const CancellationToken& cancellation) const {
    FaceDistances distances(cancellation);
    Active active;
    Active remaining;
    for (std::int32_t face = 0; face < mesh().face_count(); ++face) {
      if (marked[static_cast<std::size_t>(face)] != 0 || !reaching.reaches(FaceId(face))) continue;
      reaching.arrivals(FaceId(face), distances.arrivals());
      const std::array<Eigen::Vector2d, 3> corners = planar_corners(mesh(), face);
      const Eigen::Vector2d centre = (corners[0] + corners[1] + corners[2]) / 3;
      double radius = 0;
      for (const Eigen::Vector2d& corner : corners) radius = std::max(radius, (corner - centre).norm());
      distances.all(active);
      distances.prune(active, centre, radius, remaining);
      for (const std::int32_t i : remaining)
        if (static_cast<std::size_t>(distances.arrivals()[static_cast<std::size_t>(i)].source) < sources)
          marked[static_cast<std::size_t>(face)] = 1;
    }
  }

  /// Makes the distances of vertices unknown (infinite) if their site is one of these.
  void invalidate(const Flags& of_sites, std::vector<double>& known) const {
    for (std::size_t v = 0; v < known.size(); ++v)
      if (flagged(of_sites, faces.vertex_sites()[v])) known[v] = std::numeric_limits<double>::infinity();
  }

  /// Cuts the affected faces again. `old_cells` flags sites whose old cells are gone, and `new_cells` those that have
  /// new ones. Returns false, with nothing changed, if no site is left that can take over.
  bool rebuild_locally(const std::vector<SurfacePoint>& before, const Flags& old_cells, const Flags& new_cells,
                       const Execution& execution) {
    std::vector<std::int32_t> recut;
    std::vector<std::int32_t> site_of_source;
    Flags changed = old_cells;
    std::optional<GeodesicField> local_field;
    {
      const StageTimer timer(execution.cost, "propagation");
      Flags marked(static_cast<std::size_t>(mesh().face_count()), 0);
      mark_cells(before, old_cells, marked);
      std::vector<SurfacePoint> sources;
      for (std::size_t i = 0; i < sites.size(); ++i) {
        if (new_cells[i] == 0) continue;
        changed[i] = 1;
        sources.push_back(sites[i]);
      }
      std::vector<double> known = faces.vertex_distances();
      invalidate(old_cells, known);
      if (!sources.empty())
        mark_reached(field(sources, known, execution), sources.size(), marked, execution.cancellation);
      Flags affected = new_cells;
      for (std::int32_t face = 0; face < mesh().face_count(); ++face) {
        if (marked[static_cast<std::size_t>(face)] == 0) continue;
        recut.push_back(face);
        faces.visit_sites(face, [&](std::int32_t site) { affected[static_cast<std::size_t>(site)] = 1; });
      }
      invalidate(affected, known);
      sources.clear();
      for (std::size_t i = 0; i < sites.size(); ++i) {
        if (affected[i] == 0 || !has_cell(i)) continue;
        sources.push_back(sites[i]);
        site_of_source.push_back(static_cast<std::int32_t>(i));
      }
      if (sources.empty()) return false;
      local_field.emplace(field(sources, known, execution));
    }
    const StageTimer timer(execution.cost, "cells");
    faces.recut(recut, {*local_field, site_of_source, sites}, changed, execution);
    last = {true, static_cast<std::int32_t>(std::count(changed.begin(), changed.end(), 1)),
            static_cast<std::int32_t>(recut.size())};
    return true;
  }

  bool has_cell(std::size_t site) const { return first[site] == static_cast<std::int32_t>(site); }

  const Diagram& move_to(std::span<const SurfacePoint> wanted, const Execution& execution) {
    check(wanted);
    std::vector<SurfacePoint> now = checked(wanted);
    const bool near = is_near(now);
    is_current = false;
    const std::vector<SurfacePoint> before = std::exchange(sites, std::move(now));
    const std::vector<std::int32_t> old_first =
        std::exchange(first, first_in_place(mesh(), sites, execution.cancellation));
    if (!near || !try_local_rebuild(before, old_first, execution)) rebuild_all(execution);
    write(execution);
    if (execution.cost != nullptr && last.local) execution.cost->add_quantity("local_rebuilds", 1);
    is_current = true;
    return diagram;
  }

  std::vector<SurfacePoint> checked(std::span<const SurfacePoint> points) const {
    std::vector<SurfacePoint> result;
    result.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      result.push_back(surface::checked_point(mesh(), points[i], "sites/" + std::to_string(i)));
    return result;
  }

  /// Rebuilds the diagram locally; true also if no site has moved.
  bool try_local_rebuild(const std::vector<SurfacePoint>& before, const std::vector<std::int32_t>& old_first,
                         const Execution& execution) {
    Flags old_cells(sites.size(), 0);
    Flags new_cells(sites.size(), 0);
    bool any = false;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const bool had_cell = old_first[i] == static_cast<std::int32_t>(i);
      const bool moved = !same_point(before[i], sites[i]) || had_cell != has_cell(i);
      old_cells[i] = had_cell && moved ? 1 : 0;
      new_cells[i] = has_cell(i) && moved ? 1 : 0;
      any = any || old_cells[i] != 0 || new_cells[i] != 0;
    }
    last = {true, 0, 0};
    return !any || rebuild_locally(before, old_cells, new_cells, execution);
  }

  void check(std::span<const SurfacePoint> wanted) const {
    check_site_count(static_cast<std::int64_t>(wanted.size()));
    if (options.method == DiagramMethod::bounded && !(options.relative_error > 0 && options.relative_error <= 1)) {
      throw Error("voronoi.invalid_option", "An option of the diagram is out of its range.",
                  {{"relative_error", "must be above 0 and at most 1"}});
    }
    if (!(options.border_deviation >= min_border_deviation && options.border_deviation <= 1)) {
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
  std::vector<std::int32_t> first;  ///< first site in the place of each site
  Diagram diagram;
  DiagramRebuild last;
  bool is_current = false;  ///< whether `faces` are up to date with `sites`
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
std::int64_t MovingDiagram::memory_bytes() const { return implementation_->faces.memory_bytes(); }
bool MovingDiagram::is_near(std::span<const SurfacePoint> sites) const {
  return implementation_->is_near(implementation_->checked(sites));
}

}  // namespace supple::voronoi
