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

/// Of a face: the site, or one of these.
inline constexpr std::int32_t cut_face_site = -1;
inline constexpr std::int32_t unreached_face_site = -2;

/// What every face of a mesh adds to a diagram: the cuts of its sides and what lies inside. Each side belongs to one of
/// its faces and is cut once, so that both see the same. Faces can be cut again one by one.
class DiagramFaces {
 public:
  /// `mesh` outlives this.
  DiagramFaces(const surface::TriangleMesh& mesh, const DiagramOptions& options);

  /// Where distances come from: a field that keeps its windows, whose i-th source is the site site_of_source[i].
  struct Source {
    const surface::GeodesicField& field;
    std::span<const std::int32_t> site_of_source;
    std::span<const surface::SurfacePoint> sites;  ///< all of the diagram
  };

  /// Cuts every face. In parallel; bills nothing.
  void cut_all(const Source& source, const Execution& execution);

  /// Cuts these faces again, ascending, by distances that are right in them. Sides between one of them and another face
  /// stay as they are, and so do vertices that sites of `changed` (a flag for each) neither had nor get, or that not
  /// all faces round are among these: what differs there is rounding. O(faces), in parallel.
  void cut_again(const std::vector<std::int32_t>& faces, const Source& source, const std::vector<std::uint8_t>& changed,
                 const Execution& execution);

  const surface::TriangleMesh& mesh() const { return *mesh_; }
  /// Of each vertex the distance from its site, and the site; infinity and -1 where no path leads to one.
  const std::vector<double>& vertex_distances() const { return vertex_distances_; }
  const std::vector<std::int32_t>& vertex_sites() const { return vertex_sites_; }
  /// Of each face the site, or one of the above.
  const std::vector<std::int32_t>& face_sites() const { return face_sites_; }
  /// Null for faces that are not cut.
  const CutFace* cut_face(std::int32_t face) const { return cut_faces_[static_cast<std::size_t>(face)].get(); }
  /// Of the sites that have a part of the face; empty unless they were asked for.
  using PartMoments = std::vector<std::pair<std::int32_t, CellMoments>>;
  const PartMoments& moments(std::int32_t face) const { return moments_[static_cast<std::size_t>(face)]; }

  /// Whether the face of a halfedge is the one that its side belongs to.
  bool owns_side(std::int32_t h) const { return mesh_->twin(h) < 0 || h < mesh_->twin(h); }
  /// How the side of a halfedge that owns it is cut.
  const LabelledSegment& side(std::int32_t h) const { return sides_[static_cast<std::size_t>(h)]; }
  /// The same as the face of any halfedge sees it.
  LabelledSegment side_seen(std::int32_t h) const;

  /// Visits the sites that a part of the face, of its sides or one of its corners belongs to, some several times.
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

  /// `again` has a flag for each face, or is null where all are cut.
  void cut(const std::vector<std::int32_t>& faces, const std::vector<std::uint8_t>* again, const Source& source,
           const Execution& execution);

  const surface::TriangleMesh* mesh_;
  DiagramOptions options_;
  BorderAccuracy accuracy_;
  std::vector<double> vertex_distances_;
  std::vector<std::int32_t> vertex_sites_;
  std::vector<std::int32_t> face_sites_;
  std::vector<LabelledSegment> sides_;  ///< of halfedges that own theirs
  std::vector<std::unique_ptr<CutFace>> cut_faces_;
  std::vector<PartMoments> moments_;
  /// Whether paths can turn at each vertex: if not, the way by it is nowhere the only shortest.
  std::vector<std::uint8_t> bends_paths_;
};

/// Fills all of a diagram that has its sites and an empty cell for each: of the faces' parts, in their order. O(points
/// of the borders + faces), in part in parallel. Bills "cut_faces" and "subdivisions".
void write_diagram(const DiagramFaces& faces, const DiagramOptions& options, const Execution& execution,
                   Diagram& diagram);

}  // namespace supple::voronoi
