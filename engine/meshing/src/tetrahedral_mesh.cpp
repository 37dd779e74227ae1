#include "supple/meshing/tetrahedral_mesh.h"

#include <gmsh.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

#include "canonical_surface.h"
#include "closed_surface.h"
#include "fill_here.h"
#include "gmsh_owner.h"
#include "graded_size.h"
#include "supple/base/error.h"

namespace supple::meshing {
namespace {

/// gmsh's number of the Delaunay algorithm. HXT, number 10, takes a tenth of the time and gives another mesh each time.
constexpr int delaunay = 1;
/// gmsh's numbers of the types of elements.
constexpr int linear_triangle = 2;
constexpr int linear_tetrahedron = 4;

/// Number of tetrahedra with edges of length 1 in a unit volume, a lower bound: gmsh's meshes have between 4.6 and 5.
constexpr double tetrahedra_in_unit_volume = 4.5;

/// Limit of gmsh's calls of the size callback for each tetrahedron of the finished mesh.
constexpr double max_calls_per_tetrahedron = 60;

/// Tetrahedra fill a surface if the volumes agree to this relative error, which is due to the rounding of their sums.
constexpr double volume_tolerance = 1e-11;

[[noreturn]] void throw_too_many(double number, const FillOptions& options) {
  const auto counted = std::to_string(static_cast<std::int64_t>(std::min(number, 1e18)));
  const std::string limit = std::to_string(options.max_tetrahedra);
  throw Error("solid.too_many_elements",
              "The solid would take " + counted + " tetrahedra or more; the limit is " + limit + ".",
              {{"element_size", "gives " + counted + " tetrahedra or more, limit " + limit}});
}

[[noreturn]] void throw_not_filled(const std::string& reason) {
  throw Error("solid.not_filled",
              "The surface cannot be filled with tetrahedra: it crosses or touches itself, or encloses nothing.",
              {{"surface", reason}});
}

GradedSize wanted_size(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces,
                       const FillOptions& options) {
  std::vector<double> sums(positions.size(), 0);
  std::vector<int> counts(positions.size(), 0);
  double all = 0;
  for (const SurfaceTriangle& face : faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(face[k]);
      const auto b = static_cast<std::size_t>(face[(k + 1) % 3]);
      const double length = (positions[a] - positions[b]).norm();
      all += length;
      for (const std::size_t end : {a, b}) {
        sums[end] += length;
        ++counts[end];
      }
    }
  std::vector<GradedSize::Source> sources;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (counts[i] > 0) sources.push_back({positions[i], sums[i] / counts[i]});
  const double mean = all / (3 * static_cast<double>(faces.size()));
  return GradedSize(std::move(sources), options.element_size > 0 ? options.element_size : mean, options.grading);
}

/// gmsh's size callback. After a stop request or too many calls, it returns a length so large that gmsh makes no more
/// tetrahedra, since an exception cannot pass through gmsh.
class SizeCallback {
 public:
  SizeCallback(const GradedSize& size, const FillOptions& options, const CancellationToken& cancellation)
      : size_(size),
        cancellation_(cancellation),
        max_calls_(max_calls_per_tetrahedron * static_cast<double>(options.max_tetrahedra)) {}

  double operator()(const Eigen::Vector3d& point) {
    ++calls_;
    return too_many() || cancellation_.requested() ? huge_length : size_(point);
  }
  bool too_many() const { return static_cast<double>(calls_) > max_calls_; }

 private:
  static constexpr double huge_length = 1e22;
  const GradedSize& size_;
  const CancellationToken& cancellation_;
  double max_calls_;
  std::int64_t calls_ = 0;
};

/// gmsh's mesh of one solid.
struct Filling {
  std::vector<Eigen::Vector3d> inner;
  /// Their corners: vertices of the surface by their numbers, and inner nodes by numbers that follow those of vertices.
  std::vector<Tetrahedron> tetrahedra;
};

/// Adds each component of a solid to gmsh's model, as a surface of its own. Node tags are numbers of vertices plus 1.
void add_surfaces(std::span<const Eigen::Vector3d> positions, const ClosedSurface& surface, const Solid& solid) {
  std::vector<int> loops;
  std::vector<bool> added(positions.size(), false);
  for (const std::size_t number : solid) {
    const int entity = gmsh::model::addDiscreteEntity(2);
    std::vector<std::size_t> tags, corners;
    std::vector<double> coordinates;
    for (const SurfaceTriangle& face : surface.components()[number])
      for (const std::int32_t vertex : face) {
        const auto i = static_cast<std::size_t>(vertex);
        corners.push_back(i + 1);
        if (added[i]) continue;
        added[i] = true;
        tags.push_back(i + 1);
        coordinates.insert(coordinates.end(), positions[i].data(), positions[i].data() + 3);
      }
    gmsh::model::mesh::addNodes(2, entity, tags, coordinates);
    gmsh::model::mesh::addElementsByType(entity, linear_triangle, {}, corners);
    loops.push_back(gmsh::model::geo::addSurfaceLoop({entity}));
  }
  gmsh::model::geo::addVolume(loops);
  gmsh::model::geo::synchronize();
}

/// Reads gmsh's mesh of one solid. Throws std::out_of_range for a node that is neither a vertex nor inside.
Filling read_filling(std::size_t vertices) {
  Filling filling;
  std::vector<std::size_t> tags;
  std::vector<double> coordinates, parametric;
  gmsh::model::mesh::getNodes(tags, coordinates, parametric, 3);
  std::unordered_map<std::size_t, std::int32_t> inner;
  for (std::size_t k = 0; k < tags.size(); ++k) {
    inner.emplace(tags[k], static_cast<std::int32_t>(vertices + filling.inner.size()));
    filling.inner.emplace_back(coordinates[3 * k], coordinates[3 * k + 1], coordinates[3 * k + 2]);
  }
  std::vector<std::size_t> elements, corners;
  gmsh::model::mesh::getElementsByType(linear_tetrahedron, elements, corners);
  const auto node = [&](std::size_t tag) {
    const auto found = inner.find(tag);
    if (found != inner.end()) return found->second;
    if (tag < 1 || tag > vertices) throw std::out_of_range("a node on the surface that is no vertex");
    return static_cast<std::int32_t>(tag - 1);
  };
  filling.tetrahedra.reserve(corners.size() / 4);
  for (std::size_t k = 0; k + 3 < corners.size(); k += 4)
    filling.tetrahedra.push_back({node(corners[k]), node(corners[k + 1]), node(corners[k + 2]), node(corners[k + 3])});
  return filling;
}

SurfaceTriangle sorted(SurfaceTriangle triangle) {
  std::ranges::sort(triangle);
  return triangle;
}

/// Whether every triangle of the solid's surface is the face of exactly one tetrahedron, and no other triangle is.
bool keeps_surface(const std::vector<Tetrahedron>& tetrahedra, const ClosedSurface& surface, const Solid& solid) {
  std::vector<SurfaceTriangle> faces;
  faces.reserve(4 * tetrahedra.size());
  for (const auto& [a, b, c, d] : tetrahedra)
    for (const SurfaceTriangle& face : {SurfaceTriangle{a, b, c}, {a, b, d}, {a, c, d}, {b, c, d}})
      faces.push_back(sorted(face));
  std::ranges::sort(faces);
  std::vector<SurfaceTriangle> outer;
  for (std::size_t first = 0, end = 0; first < faces.size(); first = end) {
    while (end < faces.size() && faces[end] == faces[first]) ++end;
    if (end - first == 1) outer.push_back(faces[first]);
    if (end - first > 2) return false;
  }
  std::vector<SurfaceTriangle> wanted;
  for (const std::size_t number : solid)
    for (const SurfaceTriangle& face : surface.components()[number]) wanted.push_back(sorted(face));
  std::ranges::sort(wanted);
  return outer == wanted;
}

/// What is wrong with the tetrahedra from `first` on; empty if they fill the solid.
std::string fault_of(const TetrahedralMesh& mesh, std::size_t first, const ClosedSurface& surface, const Solid& solid) {
  const std::vector<Tetrahedron> own(mesh.tetrahedra.begin() + static_cast<std::ptrdiff_t>(first),
                                     mesh.tetrahedra.end());
  if (own.empty()) return "no tetrahedra";
  double volume = 0;
  for (const auto& [a, b, c, d] : own) {
    const double part =
        tetrahedron_volume(mesh.nodes[static_cast<std::size_t>(a)], mesh.nodes[static_cast<std::size_t>(b)],
                           mesh.nodes[static_cast<std::size_t>(c)], mesh.nodes[static_cast<std::size_t>(d)]);
    if (!(part > 0)) return "a tetrahedron of no volume";
    volume += part;
  }
  if (!keeps_surface(own, surface, solid)) return "the tetrahedra do not end at the surface";
  const double wanted = surface.volume(solid);
  if (!(std::abs(volume - wanted) <= volume_tolerance * wanted)) return "the tetrahedra do not fill the volume";
  return {};
}

/// Fills a surface in its own coordinates and numbering.
TetrahedralMesh fill_as_given(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces,
                              const FillOptions& options, const Execution& execution) {
  const ClosedSurface surface(positions, faces);
  const GradedSize size = wanted_size(positions, faces, options);
  double volume = 0;
  for (const Solid& solid : surface.solids()) volume += surface.volume(solid);
  const double predicted = tetrahedra_in_unit_volume * volume / std::pow(size.max_length(), 3);
  if (predicted > static_cast<double>(options.max_tetrahedra)) throw_too_many(predicted, options);

  TetrahedralMesh mesh;
  mesh.nodes.assign(positions.begin(), positions.end());
  mesh.surface_vertices = static_cast<std::int32_t>(positions.size());
  const GmshSession session;
  SizeCallback callback(size, options, execution.cancellation);
  for (std::size_t s = 0; s < surface.solids().size(); ++s) {
    const Solid& solid = surface.solids()[s];
    execution.checkpoint(static_cast<double>(s) / static_cast<double>(surface.solids().size()), "meshing");
    Filling filling;
    try {
      const GmshModel model(session);
      gmsh::option::setNumber("Mesh.Algorithm3D", delaunay);
      // The callback alone decides the lengths inside.
      gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 0);
      // Nodes keep their tags, which are numbers of vertices plus 1.
      gmsh::option::setNumber("Mesh.Renumber", 0);
      gmsh::model::mesh::setSizeCallback(
          [&callback](int, int, double x, double y, double z) { return callback(Eigen::Vector3d(x, y, z)); });
      add_surfaces(positions, surface, solid);
      gmsh::model::mesh::generate(3);
      filling = read_filling(positions.size());
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const Cancelled&) {
      throw;
    } catch (...) {  // gmsh throws strings, integers and exceptions
      execution.cancellation.throw_if_requested();
      throw_not_filled("no mesh: " + last_gmsh_error(session));
    }
    execution.cancellation.throw_if_requested();
    const std::size_t first = mesh.tetrahedra.size();
    const auto shift = static_cast<std::int32_t>(mesh.nodes.size() - positions.size());
    mesh.nodes.insert(mesh.nodes.end(), filling.inner.begin(), filling.inner.end());
    for (Tetrahedron& tetrahedron : filling.tetrahedra) {
      for (std::int32_t& corner : tetrahedron)
        if (corner >= mesh.surface_vertices) corner += shift;
      mesh.tetrahedra.push_back(tetrahedron);
    }
    if (callback.too_many() || static_cast<std::int64_t>(mesh.tetrahedra.size()) > options.max_tetrahedra)
      throw_too_many(
          std::max(static_cast<double>(mesh.tetrahedra.size()), static_cast<double>(options.max_tetrahedra) + 1),
          options);
    if (const std::string fault = fault_of(mesh, first, surface, solid); !fault.empty())
      throw_not_filled(fault + ": " + last_gmsh_error(session));
  }
  return mesh;
}

/// Transforms a mesh from the canonical frame into the given one, with vertices in their given order and positions.
TetrahedralMesh in_given_frame(TetrahedralMesh canonical, const CanonicalSurface& frame,
                               std::span<const Eigen::Vector3d> positions) {
  TetrahedralMesh mesh;
  mesh.surface_vertices = static_cast<std::int32_t>(positions.size());
  mesh.nodes.assign(positions.begin(), positions.end());
  for (std::size_t i = frame.vertices.size(); i < canonical.nodes.size(); ++i)
    mesh.nodes.push_back(frame.given(canonical.nodes[i]));
  mesh.tetrahedra = std::move(canonical.tetrahedra);
  const auto shift = mesh.surface_vertices - canonical.surface_vertices;
  for (Tetrahedron& tetrahedron : mesh.tetrahedra)
    for (std::int32_t& corner : tetrahedron)
      corner = corner < canonical.surface_vertices ? frame.vertices[static_cast<std::size_t>(corner)] : corner + shift;
  return mesh;
}

bool has_only_positive_tetrahedra(const TetrahedralMesh& mesh) {
  const auto node = [&](std::int32_t number) { return mesh.nodes[static_cast<std::size_t>(number)]; };
  return std::ranges::all_of(mesh.tetrahedra, [&](const Tetrahedron& t) {
    return tetrahedron_volume(node(t[0]), node(t[1]), node(t[2]), node(t[3])) > 0;
  });
}

}  // namespace

double tetrahedron_volume(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                          const Eigen::Vector3d& d) {
  return (b - a).dot((c - a).cross(d - a)) / 6;
}

double TetrahedralMesh::volume() const {
  double sum = 0;
  for (const auto& [a, b, c, d] : tetrahedra)
    sum += tetrahedron_volume(nodes[static_cast<std::size_t>(a)], nodes[static_cast<std::size_t>(b)],
                              nodes[static_cast<std::size_t>(c)], nodes[static_cast<std::size_t>(d)]);
  return sum;
}

TetrahedralMesh fill_here(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces,
                          const FillOptions& options, const Execution& execution) {
  if (!(options.element_size >= 0) || !(options.grading > 0) || options.max_tetrahedra < 1)
    throw std::invalid_argument("fill: element_size is 0 or more, grading and max_tetrahedra are positive");
  execution.checkpoint(0, "meshing");
  if (faces.empty()) throw_not_filled("it has no faces");
  // This check names faults by the caller's numbers of vertices.
  const ClosedSurface checked(positions, faces);
  const StageTimer timer(execution.cost, "meshing");
  const CanonicalSurface canonical = canonical_surface(positions, faces);
  FillOptions canonical_options = options;
  canonical_options.element_size /= canonical.length;
  TetrahedralMesh mesh = in_given_frame(
      fill_as_given(canonical.positions, canonical.faces, canonical_options, execution), canonical, positions);
  // Rounding to the grid of the canonical frame may turn a very flat tetrahedron inside out.
  if (!has_only_positive_tetrahedra(mesh)) mesh = fill_as_given(positions, faces, options, execution);
  execution.checkpoint(1, "meshing");
  return mesh;
}

}  // namespace supple::meshing
