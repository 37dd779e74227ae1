#include "supple/voronoi/diagram.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "cell_assembly.h"
#include "face_cutter.h"
#include "supple/base/error.h"
#include "supple/base/parallel_tasks.h"
#include "supple/base/random.h"
#include "supple/surface/geodesic_field.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using surface::TriangleMesh;

constexpr std::int64_t most_sites = 1'000'000;
/// Relative to the mean edge: sites closer than this are one, and so are Voronoi vertices.
constexpr double same_site = 1e-13;
constexpr double same_vertex = 1e-10;
/// And so are the places that unfolding shows a site at.
constexpr double same_place = 1e-9;
/// How often a triangle is divided in four for quadrature.
constexpr int most_quarterings = 3;
/// Faces of one task: each takes some microseconds.
constexpr std::int32_t faces_of_a_task = 256;

/// Of a face: the site, or one of these.
constexpr std::int32_t cut = -1;
constexpr std::int32_t unreached = -2;

/// A face in its plane: corner 0 at the origin, the axes those of tangent_frame.
std::array<Vector2d, 3> planar_corners(const TriangleMesh& mesh, std::int32_t face) {
  const surface::Triangle& corners = mesh.faces()[static_cast<std::size_t>(face)];
  const auto& p = mesh.positions();
  const Vector3d along = p[static_cast<std::size_t>(corners[1])] - p[static_cast<std::size_t>(corners[0])];
  const Vector3d to_apex = p[static_cast<std::size_t>(corners[2])] - p[static_cast<std::size_t>(corners[0])];
  const double length = along.norm();
  return {Vector2d(0, 0), Vector2d(length, 0), Vector2d(along.dot(to_apex), along.cross(to_apex).norm()) / length};
}

Vector3d barycentric(const std::array<Vector2d, 3>& corners, const Vector2d& point) {
  // The third corner alone has a height over the first side.
  const double c = point.y() / corners[2].y();
  const double b = (point.x() - c * corners[2].x()) / corners[1].x();
  Vector3d result(1 - b - c, b, c);
  result = result.cwiseMax(0.0);
  return result / result.sum();
}

/// How the sides of faces are cut, each as the halfedge that owns it sees it.
class CutSides {
 public:
  explicit CutSides(const TriangleMesh& mesh) : mesh_(mesh), labels_(static_cast<std::size_t>(mesh.halfedge_count())) {}

  bool owns(std::int32_t h) const { return mesh_.twin(h) < 0 || h < mesh_.twin(h); }
  /// Of an owned halfedge.
  LabelledSegment& at(std::int32_t h) { return labels_[static_cast<std::size_t>(h)]; }
  const LabelledSegment& at(std::int32_t h) const { return labels_[static_cast<std::size_t>(h)]; }
  /// As the face of h sees it.
  LabelledSegment seen(std::int32_t h) const {
    if (owns(h)) return at(h);
    LabelledSegment result = at(mesh_.twin(h));
    std::reverse(result.cuts.begin(), result.cuts.end());
    std::reverse(result.sites.begin(), result.sites.end());
    for (double& share : result.cuts) share = 1 - share;
    return result;
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<LabelledSegment> labels_;
};

/// In which direction paths of an arrival leave the site, for one of them: others of the same image are turned against
/// it by as much as they are where they arrive.
struct Departure {
  bool known = false;
  Eigen::Vector2d turn = Eigen::Vector2d::Zero();      ///< where the path turns last
  Eigen::Vector2d arriving = Eigen::Vector2d::Zero();  ///< its direction in the face
  Eigen::Vector2d by_site = Eigen::Vector2d::Zero();
};

struct Workspace {
  FaceDistances distances;
  Active active;
  Active kept;
  std::vector<Departure> departures;  ///< one for each arrival of the face
};

class Builder {
 public:
  Builder(const TriangleMesh& mesh, const surface::GeodesicField& field, const DiagramOptions& options,
          Diagram& diagram)
      : mesh_(mesh),
        field_(field),
        options_(options),
        diagram_(diagram),
        sides_(mesh),
        faces_(static_cast<std::size_t>(mesh.face_count())) {}

  void run(const Execution& execution) {
    diagram_.vertex_sites = field_.vertex_sources();
    diagram_.face_sites.assign(faces_.size(), unreached);
    {
      const StageTimer timer(execution.cost, "cells");
      for_faces(execution, [&](std::int32_t face, Workspace& work) { label_sides(face, work); });
      for_faces(execution, [&](std::int32_t face, Workspace& work) { cut_inside(face, work); });
    }
    const StageTimer timer(execution.cost, "assembly");
    number_points();
    collect(execution);
  }

 private:
  template <typename Body>
  void for_faces(const Execution& execution, const Body& body) const {
    const std::int32_t count = mesh_.face_count();
    Execution quiet = execution;
    quiet.progress = nullptr;
    parallel_tasks((count + faces_of_a_task - 1) / faces_of_a_task, quiet, "cells",
                   [&](int task, const Execution& /*own*/) {
                     Workspace work;
                     const std::int32_t begin = task * faces_of_a_task;
                     for (std::int32_t face = begin; face < std::min(count, begin + faces_of_a_task); ++face)
                       body(face, work);
                   });
  }

  std::int32_t site_at(std::int32_t vertex) const { return diagram_.vertex_sites[static_cast<std::size_t>(vertex)]; }

  /// The site of the whole face, or `cut` where more than one may have a part of it. Fills `kept`.
  std::int32_t single_site(std::int32_t face, const std::array<Vector2d, 3>& corners, Workspace& work) const {
    field_.arrivals(FaceId(face), work.distances.arrivals());
    if (work.distances.arrivals().empty()) return unreached;
    work.distances.all(work.active);
    std::int32_t site = work.distances.arrivals().front().source;
    work.kept = work.active;
    if (!work.distances.of_one_site(work.active)) {
      const Vector2d centre = (corners[0] + corners[1] + corners[2]) / 3;
      double radius = 0;
      for (const Vector2d& corner : corners) radius = std::max(radius, (corner - centre).norm());
      site = work.distances.prune(work.active, centre, radius, work.kept).site;
      if (!work.distances.of_one_site(work.kept)) return cut;
    }
    for (const std::int32_t v : mesh_.faces()[static_cast<std::size_t>(face)])
      if (site_at(v) != site) return cut;
    return site;
  }

  void label_sides(std::int32_t face, Workspace& work) {
    const std::array<Vector2d, 3> corners = planar_corners(mesh_, face);
    const std::int32_t site = single_site(face, corners, work);
    diagram_.face_sites[static_cast<std::size_t>(face)] = site;
    if (site == unreached) return;
    for (std::int32_t h = 3 * face; h < 3 * face + 3; ++h) {
      if (!sides_.owns(h)) continue;
      if (site >= 0)
        sides_.at(h).sites.assign(1, site);
      else
        sides_.at(h) = label_segment(work.distances, work.kept, corners[static_cast<std::size_t>(h % 3)],
                                     corners[static_cast<std::size_t>((h + 1) % 3)], site_at(mesh_.tail(h)),
                                     site_at(mesh_.head(h)));
    }
  }

  void cut_inside(std::int32_t face, Workspace& work) {
    std::int32_t& site = diagram_.face_sites[static_cast<std::size_t>(face)];
    if (site == unreached) return;
    std::array<LabelledSegment, 3> sides;
    bool whole = site >= 0;
    for (int i = 0; i < 3; ++i) {
      sides[static_cast<std::size_t>(i)] = sides_.seen(3 * face + i);
      const LabelledSegment& side = sides[static_cast<std::size_t>(i)];
      whole = whole && side.cuts.empty() && side.sites.front() == site;
    }
    if (whole) return;
    field_.arrivals(FaceId(face), work.distances.arrivals());
    CutFace result = cut_face(work.distances, planar_corners(mesh_, face), {&sides[0], &sides[1], &sides[2]},
                              options_.border_samples);
    if (result.borders.empty() && result.pieces.size() == 1) {
      site = result.pieces.front().site;
      return;
    }
    site = cut;
    faces_[static_cast<std::size_t>(face)] = std::make_unique<CutFace>(std::move(result));
  }

  /// Gives every cut of a side and every point of a face its number.
  void number_points() {
    first_cut_.assign(static_cast<std::size_t>(mesh_.halfedge_count()), -1);
    for (std::int32_t h = 0; h < mesh_.halfedge_count(); ++h) {
      if (!sides_.owns(h)) continue;
      first_cut_[static_cast<std::size_t>(h)] = static_cast<std::int32_t>(diagram_.points.size());
      const LabelledSegment& side = sides_.at(h);
      for (std::size_t i = 0; i < side.cuts.size(); ++i) {
        const double share = side.cuts[i];
        DiagramPoint point;
        point.kind = DiagramPoint::Kind::crossing;
        point.point.face = FaceId(h / 3);
        point.point.barycentric[h % 3] = 1 - share;
        point.point.barycentric[(h + 1) % 3] = share;
        point.position = surface::position(mesh_, point.point);
        point.distance = side.distances[i];
        diagram_.points.push_back(std::move(point));
      }
    }
  }

  /// The number of a cut of the face, counted as in FaceBorder.
  std::int32_t cut_number(std::int32_t face, std::int32_t number) const {
    for (std::int32_t h = 3 * face; h < 3 * face + 3; ++h) {
      const std::int32_t owner = sides_.owns(h) ? h : mesh_.twin(h);
      const auto count = static_cast<std::int32_t>(sides_.at(owner).cuts.size());
      if (number < count)
        return first_cut_[static_cast<std::size_t>(owner)] + (owner == h ? number : count - 1 - number);
      number -= count;
    }
    return -1;
  }

  void collect(const Execution& execution) {
    std::vector<BorderPart> parts;
    std::int64_t subdivisions = 0;
    std::int64_t cut_faces = 0;
    std::int64_t unresolved = 0;
    for (std::int32_t face = 0; face < mesh_.face_count(); ++face) {
      const std::int32_t site = diagram_.face_sites[static_cast<std::size_t>(face)];
      const std::array<Vector2d, 3> corners = planar_corners(mesh_, face);
      const double area = 0.5 * corners[1].x() * corners[2].y();
      if (site == unreached) diagram_.unreached_area += area;
      if (site >= 0) diagram_.cells[static_cast<std::size_t>(site)].area += area;
      if (site != cut) continue;
      ++cut_faces;
      const CutFace& own = *faces_[static_cast<std::size_t>(face)];
      subdivisions += own.subdivisions;
      if (!own.resolved) ++unresolved;
      add_face(face, corners, own, parts);
    }
    if (unresolved > 0)
      diagram_.warnings.push_back("In " + std::to_string(unresolved) +
                                  " faces many sites are so near to each other that borders are only about right.");
    close_at_boundary(parts);
    if (options_.cell_samples) sample_cells(execution);
    assemble_cells(parts, same_vertex * mesh_.mean_edge_length(), diagram_);
    if (execution.cost == nullptr) return;
    execution.cost->add_quantity("cut_faces", static_cast<double>(cut_faces));
    execution.cost->add_quantity("subdivisions", static_cast<double>(subdivisions));
  }

  void add_face(std::int32_t face, const std::array<Vector2d, 3>& corners, const CutFace& own,
                std::vector<BorderPart>& parts) {
    const auto first_point = static_cast<std::int32_t>(diagram_.points.size());
    for (const FacePoint& point : own.points) {
      DiagramPoint added;
      added.kind = point.vertex ? DiagramPoint::Kind::vertex : DiagramPoint::Kind::inner;
      added.point = {FaceId(face), barycentric(corners, point.place)};
      added.position = surface::position(mesh_, added.point);
      added.distance = point.distance;
      diagram_.points.push_back(std::move(added));
    }
    const auto number_of = [&](std::int32_t end) { return end >= 0 ? first_point + end : cut_number(face, -1 - end); };
    for (const FaceBorder& border : own.borders)
      parts.push_back({number_of(border.from), number_of(border.to), border.left, border.right, border.length});
    for (const FacePiece& piece : own.pieces) {
      diagram_.pieces.push_back({piece.site, face, static_cast<std::int32_t>(diagram_.corners.size()),
                                 static_cast<std::int32_t>(piece.corners.size())});
      for (const Vector2d& corner : piece.corners) diagram_.corners.push_back(barycentric(corners, corner));
    }
    for (const FaceSample& sample : own.samples)
      diagram_.border_samples.push_back(
          {{sample.left, sample.right}, {FaceId(face), barycentric(corners, sample.place)}, sample.weight});
    for (const auto& [site, area] : own.areas) diagram_.cells[static_cast<std::size_t>(site)].area += area;
  }

  void sample_cells(const Execution& execution) {
    std::vector<std::int32_t> first_piece(faces_.size() + 1, 0);
    for (const DiagramPiece& piece : diagram_.pieces) ++first_piece[static_cast<std::size_t>(piece.face) + 1];
    for (std::size_t face = 0; face < faces_.size(); ++face) first_piece[face + 1] += first_piece[face];
    std::vector<std::vector<CellSample>> found(faces_.size());
    for_faces(execution, [&](std::int32_t face, Workspace& work) {
      const std::int32_t site = diagram_.face_sites[static_cast<std::size_t>(face)];
      if (site == unreached) return;
      const std::array<Vector2d, 3> corners = planar_corners(mesh_, face);
      field_.arrivals(FaceId(face), work.distances.arrivals());
      work.departures.assign(work.distances.arrivals().size(), {});
      std::vector<CellSample>& samples = found[static_cast<std::size_t>(face)];
      if (site >= 0) return sample_polygon(face, site, corners, {corners.begin(), corners.end()}, work, samples);
      for (std::int32_t i = first_piece[static_cast<std::size_t>(face)];
           i < first_piece[static_cast<std::size_t>(face) + 1]; ++i) {
        const DiagramPiece& piece = diagram_.pieces[static_cast<std::size_t>(i)];
        std::vector<Vector2d> polygon;
        const Vector3d* first_corner = &diagram_.corners[static_cast<std::size_t>(piece.first_corner)];
        for (std::int32_t k = 0; k < piece.corner_count; ++k) {
          const Vector3d& b = first_corner[k];
          polygon.emplace_back(b[0] * corners[0] + b[1] * corners[1] + b[2] * corners[2]);
        }
        sample_polygon(face, piece.site, corners, polygon, work, samples);
      }
    });
    for (const std::vector<CellSample>& samples : found)
      diagram_.cell_samples.insert(diagram_.cell_samples.end(), samples.begin(), samples.end());
  }

  /// Points of quadrature in a polygon, the triangles of which are divided where paths from the site come from several
  /// directions.
  void sample_polygon(std::int32_t face, std::int32_t site, const std::array<Vector2d, 3>& corners,
                      const std::vector<Vector2d>& polygon, Workspace& work, std::vector<CellSample>& samples) const {
    work.active.clear();
    const auto& arrivals = work.distances.arrivals();
    for (std::size_t i = 0; i < arrivals.size(); ++i)
      if (arrivals[i].source == site) work.active.push_back(static_cast<std::int32_t>(i));
    const double tolerance = same_place * mesh_.mean_edge_length();
    const auto divide = [&](const auto& self, const Vector2d& a, const Vector2d& b, const Vector2d& c,
                            int divisions) -> void {
      if (divisions > 0) {
        const Slope at_a = work.distances.from_site(work.active, site, a);
        for (const Vector2d& other : {b, c, Vector2d((a + b + c) / 3)}) {
          const Slope there = work.distances.from_site(work.active, site, other);
          if (there.arrival < 0 || work.distances.same_paths(at_a.arrival, a, there.arrival, other, tolerance))
            continue;
          const Vector2d ab = 0.5 * (a + b);
          const Vector2d bc = 0.5 * (b + c);
          const Vector2d ca = 0.5 * (c + a);
          self(self, a, ab, ca, divisions - 1);
          self(self, b, bc, ab, divisions - 1);
          self(self, c, ca, bc, divisions - 1);
          return self(self, ab, bc, ca, divisions - 1);
        }
      }
      const double doubled = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
      if (doubled == 0) return;
      for (const Vector2d& corner : {a, b, c}) {
        const Vector2d place = (a + b + c + 3 * corner) / 6;
        const Slope slope = work.distances.from_site(work.active, site, place);
        if (slope.arrival < 0) continue;
        CellSample& sample = samples.emplace_back();
        sample.site = site;
        sample.point = {FaceId(face), barycentric(corners, place)};
        sample.weight = doubled / 6;
        sample.distance = slope.distance;
        sample.by_site = gradient_by_site(sample.point, place, slope, work);
      }
    };
    for (std::size_t i = 2; i < polygon.size(); ++i)
      divide(divide, polygon[0], polygon[i - 1], polygon[i], most_quarterings);
  }

  /// One walk back to the site for each bundle of paths: a path of the same straight bundle that arrives turned by some
  /// angle has left turned by that angle, and one that turns at a vertex has left like all that do.
  Vector2d gradient_by_site(const surface::SurfacePoint& point, const Vector2d& place, const Slope& slope,
                            Workspace& work) const {
    const surface::FaceArrival& arrival = work.distances.arrivals()[static_cast<std::size_t>(slope.arrival)];
    const Vector2d& turn = arrival.turns_at(place);
    Departure& departure = work.departures[static_cast<std::size_t>(slope.arrival)];
    if (!departure.known || departure.turn != turn) {
      const surface::Geodesic geodesic = field_.geodesic(point, {.derivatives = 1});
      if (!geodesic.derivatives) return Vector2d::Zero();
      departure = {true, turn, slope.gradient, geodesic.derivatives->tangent_gradient.head<2>()};
      return departure.by_site;
    }
    if (arrival.sigma > 0 || &turn != &arrival.image) return departure.by_site;
    const double c = departure.arriving.dot(slope.gradient);
    const double s = departure.arriving.x() * slope.gradient.y() - departure.arriving.y() * slope.gradient.x();
    return {c * departure.by_site.x() - s * departure.by_site.y(),
            s * departure.by_site.x() + c * departure.by_site.y()};
  }

  /// The mesh's boundary closes the cells there.
  void close_at_boundary(std::vector<BorderPart>& parts) {
    std::vector<std::int32_t> rims(static_cast<std::size_t>(mesh_.vertex_count()), -1);
    const auto rim = [&](std::int32_t h, int corner) {
      const std::int32_t v = mesh_.faces()[static_cast<std::size_t>(h / 3)][static_cast<std::size_t>(corner)];
      std::int32_t& number = rims[static_cast<std::size_t>(v)];
      if (number >= 0) return number;
      number = static_cast<std::int32_t>(diagram_.points.size());
      DiagramPoint point;
      point.kind = DiagramPoint::Kind::rim;
      point.point.face = FaceId(h / 3);
      point.point.barycentric[corner] = 1;
      point.position = mesh_.positions()[static_cast<std::size_t>(v)];
      point.distance = field_.vertex_distances()[static_cast<std::size_t>(v)];
      diagram_.points.push_back(std::move(point));
      return number;
    };
    for (std::int32_t h = 0; h < mesh_.halfedge_count(); ++h) {
      if (mesh_.twin(h) >= 0 || diagram_.face_sites[static_cast<std::size_t>(h / 3)] == unreached) continue;
      const LabelledSegment& side = sides_.at(h);
      std::int32_t before = rim(h, h % 3);
      for (std::size_t i = 0; i < side.sites.size(); ++i) {
        const std::int32_t next = i < side.cuts.size()
                                      ? first_cut_[static_cast<std::size_t>(h)] + static_cast<std::int32_t>(i)
                                      : rim(h, (h + 1) % 3);
        parts.push_back({before, next, side.sites[i], -1, 0});
        before = next;
      }
    }
  }

  const TriangleMesh& mesh_;
  const surface::GeodesicField& field_;
  const DiagramOptions& options_;
  Diagram& diagram_;
  CutSides sides_;
  std::vector<std::unique_ptr<CutFace>> faces_;
  std::vector<std::int32_t> first_cut_;
};

/// Of each site the first one in the same place: itself where there is none.
std::vector<std::int32_t> first_in_place(const TriangleMesh& mesh, std::span<const surface::SurfacePoint> sites) {
  std::vector<std::pair<Vector3d, std::int32_t>> places;
  for (std::size_t i = 0; i < sites.size(); ++i)
    places.emplace_back(surface::position(mesh, sites[i]), static_cast<std::int32_t>(i));
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) {
    return a.first.x() != b.first.x() ? a.first.x() < b.first.x() : a.second < b.second;
  });
  // Sheets may touch in space: sites in one place are in faces that share a vertex.
  const auto touch = [&](std::int32_t a, std::int32_t b) {
    const auto& of_a = mesh.faces()[static_cast<std::size_t>(index(sites[static_cast<std::size_t>(a)].face))];
    const auto& of_b = mesh.faces()[static_cast<std::size_t>(index(sites[static_cast<std::size_t>(b)].face))];
    return std::find_first_of(of_a.begin(), of_a.end(), of_b.begin(), of_b.end()) != of_a.end();
  };
  const double reach = same_site * mesh.mean_edge_length();
  std::vector<std::int32_t> first(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) first[i] = static_cast<std::int32_t>(i);
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = i + 1; j < places.size() && places[j].first.x() - places[i].first.x() <= reach; ++j) {
      if ((places[j].first - places[i].first).norm() > reach || !touch(places[i].second, places[j].second)) continue;
      const std::int32_t a = first[static_cast<std::size_t>(places[i].second)];
      std::int32_t& b = first[static_cast<std::size_t>(places[j].second)];
      if (a < b)
        b = a;
      else
        first[static_cast<std::size_t>(places[i].second)] = b;
    }
  }
  return first;
}

/// From numbers of sources to numbers of sites: those left out have no cells.
void renumber(const std::vector<std::int32_t>& site_of_source, Diagram& diagram) {
  const auto rename = [&](std::int32_t& source) {
    if (source >= 0) source = site_of_source[static_cast<std::size_t>(source)];
  };
  const auto rename_all = [&](auto& sources) { std::for_each(sources.begin(), sources.end(), rename); };
  for (DiagramVertex& vertex : diagram.vertices) rename_all(vertex.sites);
  for (DiagramEdge& edge : diagram.edges) rename_all(edge.sites);
  for (std::array<std::int32_t, 3>& triangle : diagram.dual) rename_all(triangle);
  for (BorderSample& sample : diagram.border_samples) rename_all(sample.sites);
  for (CellSample& sample : diagram.cell_samples) rename(sample.site);
  for (DiagramPiece& piece : diagram.pieces) rename(piece.site);
  rename_all(diagram.vertex_sites);
  rename_all(diagram.face_sites);
  // Backwards, because a site's number is never less than that of its source.
  for (std::size_t i = site_of_source.size(); i-- > 0;) {
    rename_all(diagram.cells[i].neighbours);
    const auto site = static_cast<std::size_t>(site_of_source[i]);
    if (site != i) diagram.cells[site] = std::exchange(diagram.cells[i], {});
  }
}

void check_count(std::int64_t count) {
  if (count < 1)
    throw Error("voronoi.no_sites", "A Voronoi diagram needs at least one site.",
                {{"sites", std::to_string(count) + " sites, the least is 1"}});
  if (count > most_sites)
    throw Error("voronoi.too_many_sites", "A Voronoi diagram has at most 1,000,000 sites.",
                {{"sites", std::to_string(count) + " sites, the limit is 1000000"}});
}

void check(std::span<const surface::SurfacePoint> sites, const DiagramOptions& options) {
  check_count(static_cast<std::int64_t>(sites.size()));
  if (options.method == DiagramMethod::bounded && !(options.relative_error > 0 && options.relative_error <= 1)) {
    throw Error("voronoi.invalid_option", "An option of the diagram is out of its range.",
                {{"relative_error", "must be above 0 and at most 1"}});
  }
}

}  // namespace

Diagram diagram(const surface::GeodesicSolver& solver, std::span<const surface::SurfacePoint> sites,
                const DiagramOptions& options, const Execution& execution) {
  check(sites, options);
  const TriangleMesh& mesh = solver.mesh();
  Diagram result;
  result.sites.reserve(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i)
    result.sites.push_back(surface::checked_point(mesh, sites[i], "sites/" + std::to_string(i)));
  result.cells.resize(sites.size());
  const std::vector<std::int32_t> first = first_in_place(mesh, result.sites);
  std::vector<surface::SurfacePoint> sources;
  std::vector<std::int32_t> site_of_source;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i] != static_cast<std::int32_t>(i)) {
      result.warnings.push_back("Site " + std::to_string(i) + " is in the place of site " + std::to_string(first[i]) +
                                ", which has the cell.");
      continue;
    }
    sources.push_back(result.sites[i]);
    site_of_source.push_back(static_cast<std::int32_t>(i));
  }
  surface::FieldOptions field_options;
  field_options.keep_windows = options.method != DiagramMethod::edges;
  if (options.method == DiagramMethod::edges) field_options.method = surface::FieldMethod::edge_graph;
  if (options.method == DiagramMethod::bounded) field_options.relative_error = options.relative_error;
  const surface::GeodesicField field = [&] {
    const StageTimer timer(execution.cost, "propagation");
    Execution own = execution;
    own.cost = nullptr;
    return solver.field(sources, field_options, own);
  }();
  if (execution.cost != nullptr) execution.cost->add_quantity("windows", static_cast<double>(field.window_count()));
  Builder(mesh, field, options, result).run(execution);
  if (sources.size() < sites.size()) renumber(site_of_source, result);
  if (result.unreached_area > 0)
    result.warnings.emplace_back("Some components of the mesh have no site; they belong to no cell.");
  return result;
}

std::vector<surface::SurfacePoint> random_sites(const TriangleMesh& mesh, std::int64_t count, std::uint64_t seed) {
  check_count(count);
  std::vector<double> areas;
  double total = 0;
  for (std::int32_t face = 0; face < mesh.face_count(); ++face) {
    const std::array<Vector2d, 3> corners = planar_corners(mesh, face);
    areas.push_back(total += corners[1].x() * corners[2].y());
  }
  RandomStream random("voronoi_sites", seed);
  std::vector<surface::SurfacePoint> sites;
  sites.reserve(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    const auto place = std::upper_bound(areas.begin(), areas.end() - 1, random.uniform() * total);
    double b = random.uniform();
    double c = random.uniform();
    if (b + c > 1) {
      b = 1 - b;
      c = 1 - c;
    }
    sites.push_back({FaceId(static_cast<std::int32_t>(place - areas.begin())), Vector3d(1 - b - c, b, c)});
  }
  return sites;
}

}  // namespace supple::voronoi
