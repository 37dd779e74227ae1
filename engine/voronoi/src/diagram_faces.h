#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "face_cutter.h"
#include "labelled_segment.h"
#include "supple/base/execution.h"
#include "supple/surface/geodesic_field.h"
#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// Values of a face's site if no single site has the face.
inline constexpr std::int32_t cut_face_site = -1;        ///< several sites have a part of it
inline constexpr std::int32_t unreached_face_site = -2;  ///< no path leads to a site

/// The contribution of every face of a mesh to a diagram: the cuts of its sides, and what lies inside. A shared side is
/// owned by one of its faces and cut once, so that both have the same cuts. Single faces can be cut again.
///
/// Memory: 54 bytes for each face of the mesh, 95 with cell moments. A cut face takes about 0.5 KB more, and 70 bytes
/// for each face that the paths from it to its sites cross; with all that derivatives need, 1.5 KB and 190 bytes.
class DiagramFaces {
 public:
  /// `mesh` must outlive this.
  DiagramFaces(const surface::TriangleMesh& mesh, const DiagramOptions& options);

  /// The distances to cut by: a field with its windows, whose i-th source is the site site_of_source[i].
  struct Source {
    const surface::GeodesicField& field;
    std::span<const std::int32_t> site_of_source;
    std::span<const surface::SurfacePoint> sites;  ///< all sites of the diagram
  };

  /// Cuts every face, in parallel. Bills nothing.
  void cut_all(const Source& source, const Execution& execution);

  /// Cuts these faces again, which must be ascending and have the right distances in `source`. Sides shared with other
  /// faces stay as they are. A vertex gets its new site and distance if all faces around it are cut again and its old
  /// or new site is flagged in `changed`. What else differs at vertices is rounding. O(faces), in parallel.
  void recut(const std::vector<std::int32_t>& faces, const Source& source, const std::vector<std::uint8_t>& changed,
             const Execution& execution);

  const surface::TriangleMesh& mesh() const { return *mesh_; }
  /// Distance of each vertex of the mesh from its nearest site, and that site; infinity and -1 where no path leads to
  /// one.
  const std::vector<double>& vertex_distances() const { return vertex_distances_; }
  const std::vector<std::int32_t>& vertex_sites() const { return vertex_sites_; }
  /// Site of each face, cut_face_site or unreached_face_site.
  const std::vector<std::int32_t>& face_sites() const { return face_sites_; }
  /// Null if the face is not cut.
  const CutFace* cut_face(std::int32_t face) const { return cut_faces_[static_cast<std::size_t>(face)].get(); }
  /// Integrals over each site's part of a face.
  using PartMoments = std::vector<std::pair<std::int32_t, CellMoments>>;
  /// Visits the sites that have a part of the face, with the integrals over it; none unless requested.
  template <typename Visit>
  void visit_moments(std::int32_t face, const Visit& visit) const {
    if (moments_.empty()) return;
    const auto i = static_cast<std::size_t>(face);
    if (const PartMoments* parts = part_moments_[i].get()) {
      for (const auto& [site, part] : *parts) visit(site, part);
    } else if (face_sites_[i] >= 0) {
      visit(face_sites_[i], moments_[i]);
    }
  }

  /// Whether the face of a halfedge owns its side.
  bool owns_side(std::int32_t h) const { return mesh_->twin(h) < 0 || h < mesh_->twin(h); }
  /// A side of a face, as LabelledSegment has it. It is valid until the side is cut again.
  struct Side {
    std::span<const double> cuts;
    std::span<const double> distances;
    std::span<const std::int32_t> sites;  ///< empty where no path leads to a site
  };
  /// The cuts of the side of a halfedge that owns it.
  Side side(std::int32_t h) const {
    const auto i = static_cast<std::size_t>(h);
    if (const LabelledSegment* cut = cut_sides_[i].get()) return {cut->cuts, cut->distances, cut->sites};
    return {{}, {}, {&side_sites_[i], side_sites_[i] < 0 ? std::size_t{0} : std::size_t{1}}};
  }
  /// The cuts of the side of any halfedge, in the halfedge's direction.
  LabelledSegment directed_side(std::int32_t h) const;

  /// Bytes that the faces take. O(faces).
  std::int64_t memory_bytes() const;

  /// Visits the sites to which a part of the face, of its sides or one of its corners belongs, some of them several
  /// times.
  template <typename Visit>
  void visit_sites(std::int32_t face, const Visit& visit) const {
    const std::int32_t site = face_sites_[static_cast<std::size_t>(face)];
    if (site == unreached_face_site) return;
    if (site >= 0) visit(site);
    if (const CutFace* own = cut_face(face))
      for (const FacePiece& piece : own->pieces) visit(piece.site);
    for (std::int32_t h = 3 * face; h < 3 * face + 3; ++h) {
      for (const std::int32_t beside : side(owns_side(h) ? h : mesh_->twin(h)).sites) visit(beside);
      if (const std::int32_t v = vertex_sites_[static_cast<std::size_t>(mesh_->tail(h))]; v >= 0) visit(v);
    }
  }

 private:
  struct Workspace;
  class Task;

  /// `recut_flags` has a flag for each face, and is null if all faces are cut.
  void cut(const std::vector<std::int32_t>& faces, const std::vector<std::uint8_t>* recut_flags, const Source& source,
           const Execution& execution);
  void set_side(std::int32_t h, LabelledSegment side);
  void set_moments(std::int32_t face, const PartMoments& parts);

  const surface::TriangleMesh* mesh_;
  DiagramOptions options_;
  BorderAccuracy accuracy_;
  std::vector<double> vertex_distances_;
  std::vector<std::int32_t> vertex_sites_;
  std::vector<std::int32_t> face_sites_;
  // For each halfedge that owns its side:
  std::vector<std::int32_t> side_sites_;  ///< site of the whole side; -1 if it is cut, or no path leads to a site
  std::vector<std::unique_ptr<LabelledSegment>> cut_sides_;  ///< null if it is not cut
  std::vector<std::unique_ptr<CutFace>> cut_faces_;          ///< null if the face is not cut
  std::vector<CellMoments> moments_;  ///< for each face, if one site has it; empty unless requested
  std::vector<std::unique_ptr<PartMoments>> part_moments_;  ///< null where `moments_` has the integrals
  /// Whether each vertex is a saddle vertex. Shortest paths can turn only there. Filled only for cell moments.
  std::vector<std::uint8_t> saddle_vertices_;
};

/// Fills a diagram that has its sites and an empty cell for each, from the faces in their order. O(points of the
/// borders + faces), in part in parallel. Bills "cut_faces" and "subdivisions".
void write_diagram(const DiagramFaces& faces, const DiagramOptions& options, const Execution& execution,
                   Diagram& diagram);

}  // namespace supple::voronoi
