#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "cell_assembly.h"
#include "diagram_faces.h"
#include "planar_face.h"
#include "supple/base/parallel_tasks.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using surface::TriangleMesh;

/// Relative to the mean edge length: Voronoi vertices closer than this are merged.
constexpr double vertex_merge_distance = 1e-10;
/// Number of faces or halfedges per task. Each takes some tenths of a microsecond.
constexpr std::int32_t elements_per_task = 4096;

/// Writes a diagram. All elements are numbered first, so that faces can be written in parallel.
class DiagramWriter {
 public:
  DiagramWriter(const DiagramFaces& faces, const DiagramOptions& options, const Execution& execution, Diagram& diagram)
      : mesh_(faces.mesh()), faces_(faces), options_(options), execution_(execution), diagram_(diagram) {
    execution_.progress = nullptr;
  }

  void run() {
    diagram_.vertex_sites = faces_.vertex_sites();
    diagram_.face_sites = faces_.face_sites();
    number_elements();
    in_parallel(mesh_.halfedge_count(), [&](std::int32_t h) { write_side(h); });
    in_parallel(static_cast<std::int32_t>(offsets_.size()), [&](std::int32_t i) { write_face(offsets_[i]); });
    add_areas();
    close_at_boundary();
    if (options_.cell_moments && options_.method != DiagramMethod::edges) add_moments();
    assemble_cells(parts_, vertex_merge_distance * mesh_.mean_edge_length(), diagram_);
    if (options_.vertex_gradients && options_.method != DiagramMethod::edges) gather_vertex_pulls();
    if (execution_.cost == nullptr) return;
    execution_.cost->add_quantity("cut_faces", static_cast<double>(offsets_.size()));
    execution_.cost->add_quantity("subdivisions", static_cast<double>(subdivisions_));
  }

 private:
  /// Indices at which the elements of a cut face begin.
  struct FaceOffsets {
    std::int32_t face = -1;
    std::size_t point = 0;
    std::size_t part = 0;
    std::size_t piece = 0;
    std::size_t corner = 0;
    std::size_t sample = 0;
  };

  template <typename Body>
  void in_parallel(std::int32_t count, const Body& body) const {
    parallel_tasks((count + elements_per_task - 1) / elements_per_task, execution_, "assembly",
                   [&](int task, const Execution& /*own*/) {
                     const std::int32_t begin = task * elements_per_task;
                     for (std::int32_t i = begin; i < std::min(count, begin + elements_per_task); ++i) body(i);
                   });
  }

  void number_elements() {
    first_cut_.assign(static_cast<std::size_t>(mesh_.halfedge_count()), -1);
    std::size_t cuts = 0;
    for (std::int32_t h = 0; h < mesh_.halfedge_count(); ++h) {
      if (!faces_.owns_side(h)) continue;
      first_cut_[static_cast<std::size_t>(h)] = static_cast<std::int32_t>(cuts);
      cuts += faces_.side(h).cuts.size();
    }
    FaceOffsets next;
    next.point = cuts;
    for (std::int32_t face = 0; face < mesh_.face_count(); ++face) {
      const CutFace* own = faces_.cut_face(face);
      if (own == nullptr) continue;
      next.face = face;
      offsets_.push_back(next);
      next.point += own->points.size();
      next.part += own->borders.size();
      next.piece += own->pieces.size();
      for (const FacePiece& piece : own->pieces) next.corner += piece.corners.size();
      next.sample += own->border_samples.size();
    }
    diagram_.points.resize(next.point);
    parts_.resize(next.part);
    diagram_.pieces.resize(next.piece);
    diagram_.corners.resize(next.corner);
    diagram_.border_samples.resize(next.sample);
  }

  void write_side(std::int32_t h) {
    if (!faces_.owns_side(h)) return;
    const DiagramFaces::Side side = faces_.side(h);
    auto number = static_cast<std::size_t>(first_cut_[static_cast<std::size_t>(h)]);
    for (std::size_t i = 0; i < side.cuts.size(); ++i) {
      const double fraction = side.cuts[i];
      DiagramPoint& point = diagram_.points[number++];
      point.kind = DiagramPoint::Kind::crossing;
      point.point.face = FaceId(h / 3);
      point.point.barycentric[h % 3] = 1 - fraction;
      point.point.barycentric[(h + 1) % 3] = fraction;
      point.position = surface::position(mesh_, point.point);
      point.distance = side.distances[i];
    }
  }

  /// The index of the point of a cut. `number` counts the cuts of the face as FaceBorder does.
  std::int32_t cut_number(std::int32_t face, std::int32_t number) const {
    for (std::int32_t h = 3 * face; h < 3 * face + 3; ++h) {
      const std::int32_t owner = faces_.owns_side(h) ? h : mesh_.twin(h);
      const auto count = static_cast<std::int32_t>(faces_.side(owner).cuts.size());
      if (number < count)
        return first_cut_[static_cast<std::size_t>(owner)] + (owner == h ? number : count - 1 - number);
      number -= count;
    }
    return -1;
  }

  void write_face(FaceOffsets next) {
    const CutFace& own = *faces_.cut_face(next.face);
    const FaceId id{next.face};
    const std::array<Vector2d, 3> corners = planar_corners(mesh_, next.face);
    const auto first_point = static_cast<std::int32_t>(next.point);
    for (const FacePoint& point : own.points) {
      DiagramPoint& added = diagram_.points[next.point++];
      added.kind = point.vertex ? DiagramPoint::Kind::vertex : DiagramPoint::Kind::inner;
      added.point = {id, barycentric(corners, point.place)};
      added.position = surface::position(mesh_, added.point);
      added.distance = point.distance;
    }
    const auto number_of = [&](std::int32_t end) {
      return end >= 0 ? first_point + end : cut_number(next.face, -1 - end);
    };
    for (const FaceBorder& border : own.borders)
      parts_[next.part++] = {number_of(border.from), number_of(border.to), border.left, border.right, border.length};
    for (const FacePiece& piece : own.pieces) {
      diagram_.pieces[next.piece++] = {piece.site, next.face, static_cast<std::int32_t>(next.corner),
                                       static_cast<std::int32_t>(piece.corners.size()), std::max(piece.area, 0.0)};
      for (const Vector2d& corner : piece.corners) diagram_.corners[next.corner++] = barycentric(corners, corner);
    }
    std::copy(own.border_samples.begin(), own.border_samples.end(),
              diagram_.border_samples.begin() + static_cast<std::ptrdiff_t>(next.sample));
  }

  void add_areas() {
    std::int64_t unresolved = 0;
    for (std::int32_t face = 0; face < mesh_.face_count(); ++face) {
      const std::int32_t site = diagram_.face_sites[static_cast<std::size_t>(face)];
      if (site == cut_face_site) {
        const CutFace& own = *faces_.cut_face(face);
        subdivisions_ += own.subdivisions;
        if (!own.resolved) ++unresolved;
        for (const FacePiece& piece : own.pieces)
          diagram_.cells[static_cast<std::size_t>(piece.site)].area += piece.area;
        continue;
      }
      const std::array<Vector2d, 3> corners = planar_corners(mesh_, face);
      const double area = 0.5 * corners[1].x() * corners[2].y();
      if (site == unreached_face_site)
        diagram_.unreached_area += area;
      else
        diagram_.cells[static_cast<std::size_t>(site)].area += area;
    }
    if (unresolved > 0)
      diagram_.warnings.push_back("In " + std::to_string(unresolved) +
                                  " faces many sites are so near to each other that borders are only about right.");
  }

  void add_moments() {
    diagram_.cell_moments.resize(diagram_.cells.size());
    for (std::int32_t face = 0; face < mesh_.face_count(); ++face) {
      faces_.visit_moments(face, [&](std::int32_t site, const CellMoments& part) {
        CellMoments& sum = diagram_.cell_moments[static_cast<std::size_t>(site)];
        sum.squared_distance += part.squared_distance;
        sum.gradient += part.gradient;
      });
    }
  }

  /// Gathers the faces' distance gradients at the Voronoi vertices. A merged vertex has sites for which its face has
  /// none.
  void gather_vertex_pulls() {
    for (const DiagramVertex& vertex : diagram_.vertices) {
      const auto number = static_cast<std::size_t>(vertex.point);
      const auto after =
          std::upper_bound(offsets_.begin(), offsets_.end(), number,
                           [](std::size_t point, const FaceOffsets& offsets) { return point < offsets.point; });
      const FaceOffsets& offsets = *std::prev(after);
      const auto own = static_cast<std::int32_t>(number - offsets.point);
      for (const std::int32_t site : vertex.sites) {
        SiteDistanceGradient& gradient = diagram_.vertex_gradients.emplace_back();
        for (const auto& [point, stored] : faces_.cut_face(offsets.face)->vertex_gradients)
          if (point == own && stored.site == site) gradient = stored;
      }
    }
  }

  /// Closes the cells along the mesh's boundary.
  void close_at_boundary() {
    std::vector<std::int32_t> boundary_points(static_cast<std::size_t>(mesh_.vertex_count()), -1);
    const auto boundary_point = [&](std::int32_t h, int corner) {
      const std::int32_t v = mesh_.faces()[static_cast<std::size_t>(h / 3)][static_cast<std::size_t>(corner)];
      std::int32_t& number = boundary_points[static_cast<std::size_t>(v)];
      if (number >= 0) return number;
      number = static_cast<std::int32_t>(diagram_.points.size());
      DiagramPoint point;
      point.kind = DiagramPoint::Kind::boundary;
      point.point.face = FaceId(h / 3);
      point.point.barycentric[corner] = 1;
      point.position = mesh_.positions()[static_cast<std::size_t>(v)];
      point.distance = faces_.vertex_distances()[static_cast<std::size_t>(v)];
      diagram_.points.push_back(std::move(point));
      return number;
    };
    for (std::int32_t h = 0; h < mesh_.halfedge_count(); ++h) {
      if (mesh_.twin(h) >= 0 || diagram_.face_sites[static_cast<std::size_t>(h / 3)] == unreached_face_site) continue;
      const DiagramFaces::Side side = faces_.side(h);
      std::int32_t before = boundary_point(h, h % 3);
      for (std::size_t i = 0; i < side.sites.size(); ++i) {
        const std::int32_t next = i < side.cuts.size()
                                      ? first_cut_[static_cast<std::size_t>(h)] + static_cast<std::int32_t>(i)
                                      : boundary_point(h, (h + 1) % 3);
        parts_.push_back({before, next, side.sites[i], -1, 0});
        before = next;
      }
    }
  }

  const TriangleMesh& mesh_;
  const DiagramFaces& faces_;
  const DiagramOptions& options_;
  Execution execution_;
  Diagram& diagram_;
  /// For each halfedge that owns its side, the index of the point of its first cut.
  std::vector<std::int32_t> first_cut_;
  std::vector<FaceOffsets> offsets_;  ///< one for each cut face, ascending
  std::vector<BorderPart> parts_;
  std::int64_t subdivisions_ = 0;
};

}  // namespace

void write_diagram(const DiagramFaces& faces, const DiagramOptions& options, const Execution& execution,
                   Diagram& diagram) {
  DiagramWriter(faces, options, execution, diagram).run();
}

}  // namespace supple::voronoi
