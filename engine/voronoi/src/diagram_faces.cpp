#include "diagram_faces.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "planar_face.h"
#include "supple/base/parallel_tasks.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using surface::TriangleMesh;

/// Relative to the mean edge: places that unfolding shows a site at that are closer than this are one.
constexpr double same_place = 1e-9;
/// How often a triangle is divided in four for quadrature.
constexpr int most_quarterings = 3;
/// Most faces of one task: each takes some microseconds.
constexpr std::int32_t most_faces_of_a_task = 256;
/// As many tasks keep all threads busy where faces are few.
constexpr std::int32_t least_tasks = 16;

}  // namespace

/// In which direction paths of an arrival leave the site, for one of them: others of the same image are turned against
/// it by as much as they are where they arrive.
struct DiagramFaces::Departure {
  bool known = false;
  Eigen::Vector2d turn = Eigen::Vector2d::Zero();      ///< where the path turns last
  Eigen::Vector2d arriving = Eigen::Vector2d::Zero();  ///< its direction in the face
  Eigen::Vector2d by_site = Eigen::Vector2d::Zero();
};

struct DiagramFaces::Workspace {
  FaceDistances distances;
  Active active;
  Active kept;
  std::vector<Departure> departures;  ///< one for each arrival of the face
};

/// Cuts faces one after the other.
class DiagramFaces::Task {
 public:
  Task(DiagramFaces& faces, const surface::GeodesicField& field, std::span<const std::int32_t> site_of_source)
      : faces_(faces), field_(field), site_of_source_(site_of_source) {}

  /// Tells whether the face may be cut, and cuts the sides that it owns and `takes` says yes to.
  template <typename Takes>
  void label_sides(std::int32_t face, const Takes& takes) {
    const std::array<Vector2d, 3> corners = planar_corners(mesh(), face);
    const std::int32_t site = single_site(face, corners);
    faces_.face_sites_[static_cast<std::size_t>(face)] = site;
    for (std::int32_t h = 3 * face; h < 3 * face + 3; ++h) {
      if (!faces_.owns_side(h) || !takes(h)) continue;
      LabelledSegment& side = faces_.sides_[static_cast<std::size_t>(h)];
      side = {};
      if (site == unreached_face_site) continue;
      if (site >= 0)
        side.sites.assign(1, site);
      else
        side = label_segment(work_.distances, work_.kept, corners[static_cast<std::size_t>(h % 3)],
                             corners[static_cast<std::size_t>((h + 1) % 3)], site_at(mesh().tail(h)),
                             site_at(mesh().head(h)));
    }
  }

  /// Cuts the inside of a face whose sides are cut.
  void cut_inside(std::int32_t face) {
    faces_.cut_faces_[static_cast<std::size_t>(face)].reset();
    std::int32_t& site = faces_.face_sites_[static_cast<std::size_t>(face)];
    if (site == unreached_face_site) return;
    std::array<LabelledSegment, 3> sides;
    bool whole = site >= 0;
    for (int i = 0; i < 3; ++i) {
      sides[static_cast<std::size_t>(i)] = faces_.side_seen(3 * face + i);
      const LabelledSegment& side = sides[static_cast<std::size_t>(i)];
      whole = whole && side.cuts.empty() && side.sites.front() == site;
    }
    if (whole) return;
    find_arrivals(face);
    CutFace result = voronoi::cut_face(work_.distances, planar_corners(mesh(), face), {&sides[0], &sides[1], &sides[2]},
                                       faces_.options_.border_samples);
    if (result.borders.empty() && result.pieces.size() == 1) {
      site = result.pieces.front().site;
      return;
    }
    site = cut_face_site;
    faces_.cut_faces_[static_cast<std::size_t>(face)] = std::make_unique<CutFace>(std::move(result));
  }

  /// Points of quadrature in the cells' parts of a face that is cut.
  void sample(std::int32_t face) {
    std::vector<CellSample>& samples = faces_.samples_[static_cast<std::size_t>(face)];
    samples.clear();
    const std::int32_t site = faces_.face_sites_[static_cast<std::size_t>(face)];
    if (site == unreached_face_site) return;
    const std::array<Vector2d, 3> corners = planar_corners(mesh(), face);
    find_arrivals(face);
    work_.departures.assign(work_.distances.arrivals().size(), {});
    if (site >= 0) return sample_polygon(face, site, corners, {corners.begin(), corners.end()}, samples);
    for (const FacePiece& piece : faces_.cut_face(face)->pieces)
      sample_polygon(face, piece.site, corners, piece.corners, samples);
  }

 private:
  const TriangleMesh& mesh() const { return *faces_.mesh_; }
  std::int32_t site_at(std::int32_t vertex) const { return faces_.vertex_sites_[static_cast<std::size_t>(vertex)]; }

  void find_arrivals(std::int32_t face) {
    field_.arrivals(FaceId(face), work_.distances.arrivals());
    for (surface::FaceArrival& arrival : work_.distances.arrivals())
      arrival.source = site_of_source_[static_cast<std::size_t>(arrival.source)];
  }

  /// The site of the whole face, or `cut_face_site` where more than one may have a part of it. Fills `kept`.
  std::int32_t single_site(std::int32_t face, const std::array<Vector2d, 3>& corners) {
    find_arrivals(face);
    if (work_.distances.arrivals().empty()) return unreached_face_site;
    work_.distances.all(work_.active);
    std::int32_t site = work_.distances.arrivals().front().source;
    work_.kept = work_.active;
    if (!work_.distances.of_one_site(work_.active)) {
      const Vector2d centre = (corners[0] + corners[1] + corners[2]) / 3;
      double radius = 0;
      for (const Vector2d& corner : corners) radius = std::max(radius, (corner - centre).norm());
      site = work_.distances.prune(work_.active, centre, radius, work_.kept).site;
      if (!work_.distances.of_one_site(work_.kept)) return cut_face_site;
    }
    for (const std::int32_t v : mesh().faces()[static_cast<std::size_t>(face)])
      if (site_at(v) != site) return cut_face_site;
    return site;
  }

  /// Points of quadrature in a polygon, the triangles of which are divided where paths from the site come from several
  /// directions.
  void sample_polygon(std::int32_t face, std::int32_t site, const std::array<Vector2d, 3>& corners,
                      const std::vector<Vector2d>& polygon, std::vector<CellSample>& samples) {
    work_.active.clear();
    const auto& arrivals = work_.distances.arrivals();
    for (std::size_t i = 0; i < arrivals.size(); ++i)
      if (arrivals[i].source == site) work_.active.push_back(static_cast<std::int32_t>(i));
    const double tolerance = same_place * mesh().mean_edge_length();
    const auto divide = [&](const auto& self, const Vector2d& a, const Vector2d& b, const Vector2d& c,
                            int divisions) -> void {
      if (divisions > 0) {
        const Slope at_a = work_.distances.from_site(work_.active, site, a);
        for (const Vector2d& other : {b, c, Vector2d((a + b + c) / 3)}) {
          const Slope there = work_.distances.from_site(work_.active, site, other);
          if (there.arrival < 0 || work_.distances.same_paths(at_a.arrival, a, there.arrival, other, tolerance))
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
        const Slope slope = work_.distances.from_site(work_.active, site, place);
        if (slope.arrival < 0) continue;
        CellSample& sample = samples.emplace_back();
        sample.site = site;
        sample.point = {FaceId(face), barycentric(corners, place)};
        sample.weight = doubled / 6;
        sample.distance = slope.distance;
        sample.by_site = gradient_by_site(sample.point, place, slope);
      }
    };
    for (std::size_t i = 2; i < polygon.size(); ++i)
      divide(divide, polygon[0], polygon[i - 1], polygon[i], most_quarterings);
  }

  /// One walk back to the site for each bundle of paths: a path of the same straight bundle that arrives turned by some
  /// angle has left turned by that angle, and one that turns at a vertex has left like all that do.
  Vector2d gradient_by_site(const surface::SurfacePoint& point, const Vector2d& place, const Slope& slope) {
    const surface::FaceArrival& arrival = work_.distances.arrivals()[static_cast<std::size_t>(slope.arrival)];
    const Vector2d& turn = arrival.turns_at(place);
    Departure& departure = work_.departures[static_cast<std::size_t>(slope.arrival)];
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

  DiagramFaces& faces_;
  const surface::GeodesicField& field_;
  std::span<const std::int32_t> site_of_source_;
  Workspace work_;
};

DiagramFaces::DiagramFaces(const TriangleMesh& mesh, const DiagramOptions& options)
    : mesh_(&mesh),
      options_(options),
      vertex_distances_(static_cast<std::size_t>(mesh.vertex_count()), std::numeric_limits<double>::infinity()),
      vertex_sites_(vertex_distances_.size(), -1),
      face_sites_(static_cast<std::size_t>(mesh.face_count()), unreached_face_site),
      sides_(static_cast<std::size_t>(mesh.halfedge_count())),
      cut_faces_(face_sites_.size()),
      samples_(options.cell_samples ? face_sites_.size() : 0) {}

LabelledSegment DiagramFaces::side_seen(std::int32_t h) const {
  if (owns_side(h)) return side(h);
  LabelledSegment result = side(mesh_->twin(h));
  std::reverse(result.cuts.begin(), result.cuts.end());
  std::reverse(result.distances.begin(), result.distances.end());
  std::reverse(result.sites.begin(), result.sites.end());
  for (double& share : result.cuts) share = 1 - share;
  return result;
}

void DiagramFaces::cut_all(const surface::GeodesicField& field, std::span<const std::int32_t> site_of_source,
                           const Execution& execution) {
  vertex_distances_ = field.vertex_distances();
  vertex_sites_ = field.vertex_sources();
  for (std::int32_t& site : vertex_sites_)
    if (site >= 0) site = site_of_source[static_cast<std::size_t>(site)];
  std::vector<std::int32_t> all(face_sites_.size());
  std::iota(all.begin(), all.end(), 0);
  cut(all, nullptr, field, site_of_source, execution);
}

void DiagramFaces::cut_again(const std::vector<std::int32_t>& faces, const surface::GeodesicField& field,
                             std::span<const std::int32_t> site_of_source, const std::vector<std::uint8_t>& changed,
                             const Execution& execution) {
  std::vector<std::uint8_t> again(face_sites_.size(), 0);
  for (const std::int32_t face : faces) again[static_cast<std::size_t>(face)] = 1;
  const auto is_changed = [&](std::int32_t site) { return site >= 0 && changed[static_cast<std::size_t>(site)] != 0; };
  const auto surrounded = [&](std::int32_t v) {
    const std::int32_t start = mesh_->outgoing(v);
    std::int32_t h = start;
    do {
      if (again[static_cast<std::size_t>(TriangleMesh::face_of(h))] == 0) return false;
      h = mesh_->rotate(h);
    } while (h >= 0 && h != start);
    return true;
  };
  for (const std::int32_t face : faces) {
    for (const std::int32_t v : mesh_->faces()[static_cast<std::size_t>(face)]) {
      const std::int32_t source = field.vertex_sources()[static_cast<std::size_t>(v)];
      const std::int32_t site = source < 0 ? -1 : site_of_source[static_cast<std::size_t>(source)];
      std::int32_t& own = vertex_sites_[static_cast<std::size_t>(v)];
      if (!(is_changed(own) || is_changed(site)) || !surrounded(v)) continue;
      own = site;
      vertex_distances_[static_cast<std::size_t>(v)] = field.vertex_distances()[static_cast<std::size_t>(v)];
    }
  }
  cut(faces, &again, field, site_of_source, execution);
}

void DiagramFaces::cut(const std::vector<std::int32_t>& faces, const std::vector<std::uint8_t>* again,
                       const surface::GeodesicField& field, std::span<const std::int32_t> site_of_source,
                       const Execution& execution) {
  Execution quiet = execution;
  quiet.progress = nullptr;
  const auto count = static_cast<std::int32_t>(faces.size());
  const std::int32_t of_a_task = std::clamp(count / least_tasks, 1, most_faces_of_a_task);
  const auto for_faces = [&](const auto& body) {
    parallel_tasks((count + of_a_task - 1) / of_a_task, quiet, "cells", [&](int number, const Execution& /*own*/) {
      Task task(*this, field, site_of_source);
      const std::int32_t begin = number * of_a_task;
      for (std::int32_t i = begin; i < std::min(count, begin + of_a_task); ++i)
        body(task, faces[static_cast<std::size_t>(i)]);
    });
  };
  const auto takes = [&](std::int32_t h) {
    const std::int32_t other = mesh_->twin(h);
    return again == nullptr || other < 0 || (*again)[static_cast<std::size_t>(TriangleMesh::face_of(other))] != 0;
  };
  for_faces([&](Task& task, std::int32_t face) { task.label_sides(face, takes); });
  for_faces([&](Task& task, std::int32_t face) { task.cut_inside(face); });
  if (options_.cell_samples) for_faces([&](Task& task, std::int32_t face) { task.sample(face); });
}

}  // namespace supple::voronoi
