#include "diagram_faces.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "arrival_gradients.h"
#include "planar_cross.h"
#include "planar_face.h"
#include "straight_regions.h"
#include "supple/base/parallel_tasks.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using surface::TriangleMesh;

/// Relative excess up to which the total angle around a vertex counts as flat.
constexpr double flat_angle_tolerance = 1e-12;
/// Permitted quadrature error of the area between a part of a border and its chord, as a fraction of the mesh's area.
/// It is area_tolerance up to reference_face_count faces, and proportional to the number of faces beyond, up to
/// max_area_tolerance: there locating every bend would cost as much as everything else.
constexpr double area_tolerance = 1e-12;
constexpr double reference_face_count = 20;
constexpr double max_area_tolerance = 2e-10;
/// Maximum number of faces per task. Each face takes a few microseconds.
constexpr std::int32_t max_faces_per_task = 256;
/// Minimum number of tasks for few faces, to keep all threads busy.
constexpr std::int32_t min_tasks = 16;

}  // namespace

struct DiagramFaces::Workspace {
  explicit Workspace(const CancellationToken& cancellation) : distances(cancellation) {}

  FaceDistances distances;
  Active active;
  Active remaining;
  PartMoments moments;  ///< of the present face
};

/// Cuts faces one after the other.
class DiagramFaces::Task {
 public:
  Task(DiagramFaces& faces, const Source& source, const CancellationToken& cancellation)
      : faces_(faces),
        source_(source),
        work_(cancellation),
        gradients_(faces.mesh(), source.field, source.sites, work_.distances) {}

  /// Determines whether several sites may have a part of the face, and cuts those of its own sides that are included.
  template <typename Takes>
  void label_sides(std::int32_t face, const Takes& is_included) {
    const std::array<Vector2d, 3> corners = planar_corners(mesh(), face);
    const std::int32_t site = single_site(face, corners);
    faces_.face_sites_[static_cast<std::size_t>(face)] = site;
    for (std::int32_t h = 3 * face; h < 3 * face + 3; ++h) {
      if (!faces_.owns_side(h) || !is_included(h)) continue;
      LabelledSegment side;
      if (site >= 0)
        side.sites.assign(1, site);
      else if (site == cut_face_site)
        side = label_segment(work_.distances, work_.remaining, corners[static_cast<std::size_t>(h % 3)],
                             corners[static_cast<std::size_t>((h + 1) % 3)], site_at(mesh().tail(h)),
                             site_at(mesh().head(h)));
      faces_.set_side(h, std::move(side));
    }
  }

  /// Cuts the inside of a face whose sides are cut, and computes what derivatives need.
  void cut_inside(std::int32_t face) {
    work_.moments.clear();
    divide_inside(face);
    if (needs_moments()) faces_.set_moments(face, work_.moments);
  }

 private:
  void divide_inside(std::int32_t face) {
    faces_.cut_faces_[static_cast<std::size_t>(face)].reset();
    std::int32_t& site = faces_.face_sites_[static_cast<std::size_t>(face)];
    if (site == unreached_face_site) return;
    std::array<LabelledSegment, 3> sides;
    bool whole = site >= 0;
    for (int i = 0; i < 3; ++i) {
      sides[static_cast<std::size_t>(i)] = faces_.directed_side(3 * face + i);
      const LabelledSegment& side = sides[static_cast<std::size_t>(i)];
      whole = whole && side.cuts.empty() && side.sites.front() == site;
    }
    if (whole && !needs_moments()) return;
    find_arrivals(face);
    const std::array<Vector2d, 3> corners = planar_corners(mesh(), face);
    if (needs_gradients()) gradients_.begin_face(face);
    if (whole) return add_moments(face, site, corners, corners);
    CutFace result = voronoi::cut_face(work_.distances, corners, {&sides[0], &sides[1], &sides[2]},
                                       faces_.options_.border_samples || needs_moments(), faces_.accuracy_);
    if (needs_moments()) add_moments(face, result, corners);
    if (result.borders.empty() && result.pieces.size() == 1) {
      site = result.pieces.front().site;
      return;
    }
    site = cut_face_site;
    if (needs_gradients()) add_gradients(result);
    faces_.cut_faces_[static_cast<std::size_t>(face)] = std::make_unique<CutFace>(std::move(result));
  }

  const TriangleMesh& mesh() const { return *faces_.mesh_; }
  std::int32_t site_at(std::int32_t vertex) const { return faces_.vertex_sites_[static_cast<std::size_t>(vertex)]; }

  bool needs_moments() const { return !faces_.moments_.empty(); }
  bool needs_gradients() const {
    return needs_moments() || faces_.options_.vertex_gradients || faces_.options_.border_samples;
  }

  void find_arrivals(std::int32_t face) {
    source_.field.arrivals(FaceId(face), work_.distances.arrivals());
    for (surface::FaceArrival& arrival : work_.distances.arrivals())
      arrival.source = source_.site_of_source[static_cast<std::size_t>(arrival.source)];
  }

  /// The site of the whole face, or `cut_face_site` if several may have a part of it. Sets work_.remaining to the
  /// arrivals that may be the shortest.
  std::int32_t single_site(std::int32_t face, const std::array<Vector2d, 3>& corners) {
    find_arrivals(face);
    if (work_.distances.arrivals().empty()) return unreached_face_site;
    work_.distances.all(work_.active);
    std::int32_t site = work_.distances.arrivals().front().source;
    work_.remaining = work_.active;
    if (!work_.distances.are_of_one_site(work_.active)) {
      const Vector2d centre = (corners[0] + corners[1] + corners[2]) / 3;
      double radius = 0;
      for (const Vector2d& corner : corners) radius = std::max(radius, (corner - centre).norm());
      site = work_.distances.prune(work_.active, centre, radius, work_.remaining).site;
      if (!work_.distances.are_of_one_site(work_.remaining)) return cut_face_site;
    }
    for (const std::int32_t v : mesh().faces()[static_cast<std::size_t>(face)])
      if (site_at(v) != site) return cut_face_site;
    return site;
  }

  /// Adds the distance gradients at the Voronoi vertices of a face and at the samples of its borders.
  void add_gradients(CutFace& cut) {
    work_.distances.all(work_.active);
    if (faces_.options_.vertex_gradients) {
      for (const FaceBorder& border : cut.borders) {
        for (const std::int32_t end : {border.from, border.to}) {
          if (end < 0 || !cut.points[static_cast<std::size_t>(end)].vertex) continue;
          for (const std::int32_t site : {border.left, border.right}) {
            const auto is_same = [&](const auto& gradient) {
              return gradient.first == end && gradient.second.site == site;
            };
            if (std::any_of(cut.vertex_gradients.begin(), cut.vertex_gradients.end(), is_same)) continue;
            cut.vertex_gradients.emplace_back(
                end, gradients_.at(work_.active, site, cut.points[static_cast<std::size_t>(end)].place));
          }
        }
      }
    }
    if (faces_.options_.border_samples) {
      cut.border_samples.reserve(cut.samples.size());
      for (const FaceSample& sample : cut.samples)
        cut.border_samples.push_back({{gradients_.at(work_.active, sample.left, sample.place),
                                       gradients_.at(work_.active, sample.right, sample.place)},
                                      sample.weight});
    }
    cut.samples = {};
  }

  CellMoments& moments_of(std::int32_t site) {
    for (auto& [of_site, sum] : work_.moments)
      if (of_site == site) return sum;
    return work_.moments.emplace_back(site, CellMoments{}).second;
  }

  void add_moments(std::int32_t face, const CutFace& cut, const std::array<Vector2d, 3>& corners) {
    for (const FacePiece& piece : cut.pieces) add_moments(face, piece.site, corners, without_arc_corners(piece));
    work_.distances.all(work_.active);
    for (const FaceSample& sample : cut.samples) {
      if (sample.area == 0) continue;
      for (const auto& [site, area] : {std::pair(sample.left, -sample.area), {sample.right, sample.area}}) {
        const SiteDistance shortest = work_.distances.from_site(work_.active, site, sample.area_place);
        if (shortest.arrival >= 0) gradients_.add_area(shortest.arrival, sample.area_place, area, moments_of(site));
      }
    }
  }

  static std::vector<Vector2d> without_arc_corners(const FacePiece& piece) {
    std::vector<Vector2d> corners = piece.corners;
    for (std::size_t i = piece.arc_corners.size(); i-- > 0;) corners.erase(corners.begin() + piece.arc_corners[i]);
    return corners;
  }

  /// Adds the integrals over a site's part of a face, a polygon.
  void add_moments(std::int32_t face, std::int32_t site, const std::array<Vector2d, 3>& corners,
                   std::span<const Vector2d> polygon) {
    Active& of_site = work_.active;
    of_site.clear();
    const auto& arrivals = work_.distances.arrivals();
    for (std::size_t i = 0; i < arrivals.size(); ++i)
      if (arrivals[i].source == site && !is_never_shortest(face, arrivals[i], corners))
        of_site.push_back(static_cast<std::int32_t>(i));
    double size = 0;
    for (std::size_t i = 0; i < 3; ++i) size = std::max(size, (corners[(i + 1) % 3] - corners[i]).norm());
    CellMoments& sum = moments_of(site);
    double sign = 1;
    StraightRegions regions(work_.distances, size,
                            [&](const StraightRegion& region) { gradients_.add_region(region, sign, sum); });
    const auto add = [&](std::span<const Vector2d> part, double sign_of_part) {
      sign = sign_of_part;
      regions.clear();
      regions.divide(part, of_site);
      for (const Sliver& sliver : regions.slivers()) {
        gradients_.add_area(sliver.loses, sliver.place, -sign * sliver.area, sum);
        gradients_.add_area(sliver.gains, sliver.place, sign * sliver.area, sum);
      }
    };
    if (is_convex(polygon)) return add(polygon, 1);
    // The polygon is the signed sum of triangles of one corner and the sides.
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      const bool turned = cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]) < 0;
      add(std::array{polygon[0], polygon[turned ? i : i - 1], polygon[turned ? i - 1 : i]}, turned ? -1 : 1);
    }
  }

  /// Whether an arrival consists of paths that turn at a corner of the face at which no shortest path turns.
  bool is_never_shortest(std::int32_t face, const surface::FaceArrival& arrival,
                         const std::array<Vector2d, 3>& corners) const {
    if (!arrival.everywhere || !(arrival.sigma > 0) || faces_.options_.method != DiagramMethod::exact) return false;
    for (std::size_t i = 0; i < 3; ++i)
      if (arrival.image == corners[i])
        return faces_.saddle_vertices_[static_cast<std::size_t>(mesh().faces()[static_cast<std::size_t>(face)][i])] ==
               0;
    return false;
  }

  static bool is_convex(std::span<const Vector2d> polygon) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector2d& corner = polygon[(i + 1) % polygon.size()];
      if (cross(corner - polygon[i], polygon[(i + 2) % polygon.size()] - corner) < 0) return false;
    }
    return true;
  }

  DiagramFaces& faces_;
  const Source& source_;
  Workspace work_;
  ArrivalGradients gradients_;
};

DiagramFaces::DiagramFaces(const TriangleMesh& mesh, const DiagramOptions& options)
    : mesh_(&mesh),
      options_(options),
      vertex_distances_(static_cast<std::size_t>(mesh.vertex_count()), std::numeric_limits<double>::infinity()),
      vertex_sites_(vertex_distances_.size(), -1),
      face_sites_(static_cast<std::size_t>(mesh.face_count()), unreached_face_site),
      side_sites_(static_cast<std::size_t>(mesh.halfedge_count()), -1),
      cut_sides_(side_sites_.size()),
      cut_faces_(face_sites_.size()),
      moments_(options.cell_moments && options.method != DiagramMethod::edges ? face_sites_.size() : 0),
      part_moments_(moments_.size()) {
  const double tolerance =
      std::clamp(area_tolerance * mesh.face_count() / reference_face_count, area_tolerance, max_area_tolerance);
  for (std::int32_t face = 0; face < mesh.face_count(); ++face) {
    const std::array<Vector2d, 3> corners = planar_corners(mesh, face);
    accuracy_.area += tolerance * 0.5 * corners[1].x() * corners[2].y();
  }
  accuracy_.deviation = options.border_deviation * mesh.diagonal();
  accuracy_.bulge = std::min(options.border_deviation, DiagramOptions{}.border_deviation) * mesh.diagonal();
  if (options_.method == DiagramMethod::edges) options_.vertex_gradients = options_.border_samples = false;
  if (moments_.empty()) return;
  saddle_vertices_.resize(vertex_sites_.size());
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    const double flat = (mesh.is_boundary(v) ? 1 : 2) * std::numbers::pi;
    saddle_vertices_[static_cast<std::size_t>(v)] = mesh.vertex_angle(v) > flat * (1 + flat_angle_tolerance) ? 1 : 0;
  }
}

void DiagramFaces::set_side(std::int32_t h, LabelledSegment side) {
  const auto i = static_cast<std::size_t>(h);
  side_sites_[i] = side.sites.size() == 1 ? side.sites.front() : -1;
  cut_sides_[i] = side.cuts.empty() ? nullptr : std::make_unique<LabelledSegment>(std::move(side));
}

void DiagramFaces::set_moments(std::int32_t face, const PartMoments& parts) {
  const auto i = static_cast<std::size_t>(face);
  const bool whole = parts.size() == 1 && parts.front().first == face_sites_[i];
  moments_[i] = whole ? parts.front().second : CellMoments{};
  part_moments_[i] = whole || parts.empty() ? nullptr : std::make_unique<PartMoments>(parts);
}

LabelledSegment DiagramFaces::directed_side(std::int32_t h) const {
  const Side own = side(owns_side(h) ? h : mesh_->twin(h));
  LabelledSegment result;
  result.cuts.assign(own.cuts.begin(), own.cuts.end());
  result.distances.assign(own.distances.begin(), own.distances.end());
  result.sites.assign(own.sites.begin(), own.sites.end());
  if (owns_side(h)) return result;
  std::reverse(result.cuts.begin(), result.cuts.end());
  std::reverse(result.distances.begin(), result.distances.end());
  std::reverse(result.sites.begin(), result.sites.end());
  for (double& fraction : result.cuts) fraction = 1 - fraction;
  return result;
}

namespace {

template <typename Value>
std::size_t bytes_of(const std::vector<Value>& values) {
  return values.capacity() * sizeof(Value);
}

std::size_t bytes_of(const LabelledSegment& side) {
  return sizeof side + bytes_of(side.cuts) + bytes_of(side.distances) + bytes_of(side.sites);
}

std::size_t bytes_of(const CutFace& face) {
  std::size_t bytes = sizeof face + bytes_of(face.points) + bytes_of(face.borders) + bytes_of(face.pieces) +
                      bytes_of(face.samples) + bytes_of(face.vertex_gradients) + bytes_of(face.border_samples);
  for (const FacePiece& piece : face.pieces) bytes += bytes_of(piece.corners) + bytes_of(piece.arc_corners);
  return bytes;
}

}  // namespace

std::int64_t DiagramFaces::memory_bytes() const {
  std::size_t bytes = bytes_of(vertex_distances_) + bytes_of(vertex_sites_) + bytes_of(face_sites_) +
                      bytes_of(side_sites_) + bytes_of(cut_sides_) + bytes_of(cut_faces_) + bytes_of(moments_) +
                      bytes_of(part_moments_) + bytes_of(saddle_vertices_);
  for (const auto& side : cut_sides_)
    if (side) bytes += bytes_of(*side);
  for (const auto& face : cut_faces_)
    if (face) bytes += bytes_of(*face);
  for (const auto& parts : part_moments_)
    if (parts) bytes += sizeof(PartMoments) + bytes_of(*parts);
  return static_cast<std::int64_t>(bytes);
}

void DiagramFaces::cut_all(const Source& source, const Execution& execution) {
  vertex_distances_ = source.field.vertex_distances();
  vertex_sites_ = source.field.vertex_sources();
  for (std::int32_t& site : vertex_sites_)
    if (site >= 0) site = source.site_of_source[static_cast<std::size_t>(site)];
  std::vector<std::int32_t> all(face_sites_.size());
  std::iota(all.begin(), all.end(), 0);
  cut(all, nullptr, source, execution);
}

void DiagramFaces::recut(const std::vector<std::int32_t>& faces, const Source& given,
                         const std::vector<std::uint8_t>& changed, const Execution& execution) {
  std::vector<std::uint8_t> recut_flags(face_sites_.size(), 0);
  for (const std::int32_t face : faces) recut_flags[static_cast<std::size_t>(face)] = 1;
  const auto is_changed = [&](std::int32_t site) { return site >= 0 && changed[static_cast<std::size_t>(site)] != 0; };
  const auto all_faces_recut = [&](std::int32_t v) {
    const std::int32_t start = mesh_->outgoing(v);
    std::int32_t h = start;
    do {
      if (recut_flags[static_cast<std::size_t>(TriangleMesh::face_of(h))] == 0) return false;
      h = mesh_->rotate(h);
    } while (h >= 0 && h != start);
    return true;
  };
  for (const std::int32_t face : faces) {
    for (const std::int32_t v : mesh_->faces()[static_cast<std::size_t>(face)]) {
      const std::int32_t source = given.field.vertex_sources()[static_cast<std::size_t>(v)];
      const std::int32_t site = source < 0 ? -1 : given.site_of_source[static_cast<std::size_t>(source)];
      std::int32_t& own = vertex_sites_[static_cast<std::size_t>(v)];
      if (!(is_changed(own) || is_changed(site)) || !all_faces_recut(v)) continue;
      own = site;
      vertex_distances_[static_cast<std::size_t>(v)] = given.field.vertex_distances()[static_cast<std::size_t>(v)];
    }
  }
  cut(faces, &recut_flags, given, execution);
}

void DiagramFaces::cut(const std::vector<std::int32_t>& faces, const std::vector<std::uint8_t>* recut_flags,
                       const Source& source, const Execution& execution) {
  Execution unreported = execution;
  unreported.progress = nullptr;
  const auto count = static_cast<std::int32_t>(faces.size());
  const std::int32_t faces_per_task = std::clamp(count / min_tasks, 1, max_faces_per_task);
  const auto for_faces = [&](const auto& body) {
    parallel_tasks((count + faces_per_task - 1) / faces_per_task, unreported, "cells",
                   [&](int number, const Execution& /*own*/) {
                     Task task(*this, source, execution.cancellation);
                     const std::int32_t begin = number * faces_per_task;
                     for (std::int32_t i = begin; i < std::min(count, begin + faces_per_task); ++i)
                       body(task, faces[static_cast<std::size_t>(i)]);
                   });
  };
  const auto is_included = [&](std::int32_t h) {
    const std::int32_t other = mesh_->twin(h);
    return recut_flags == nullptr || other < 0 ||
           (*recut_flags)[static_cast<std::size_t>(TriangleMesh::face_of(other))] != 0;
  };
  for_faces([&](Task& task, std::int32_t face) { task.label_sides(face, is_included); });
  for_faces([&](Task& task, std::int32_t face) { task.cut_inside(face); });
}

}  // namespace supple::voronoi
