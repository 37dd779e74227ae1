#include "supple/tiling/part_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "file_makers.h"
#include "helper_run.h"
#include "part_codec.h"
#include "part_tasks.h"
#include "polygon.h"
#include "size_field.h"
#include "structure_codec.h"
#include "torus_mesh.h"
#include "triangulation.h"

namespace supple::tiling {
namespace {

constexpr std::string_view part_mesh_task = "tiling/part_mesh";

/// Memory of a simulation for each node, bytes: mesh, terms and states, and the entries of the factorization, whose
/// number grows like n log n for n nodes of a plane mesh.
constexpr double bytes_per_node = 4000;
constexpr double factor_bytes_per_node = 300;  // for each doubling of the number of nodes

// The number of nodes is estimated as a sum, whose factors make it an upper bound for parts of IH01, IH22 and IH50 with
// mesh sizes from 0.33 to 2 and corner sizes from 0.1 to 1.

/// The factor of the nodes of triangles of the wanted size on the same area; gmsh's triangles are a little smaller.
constexpr double area_factor = 1.25;
/// The factor of the nodes that the smaller triangles at re-entrant corners add: gmsh grows triangles from the outline
/// into the solid less quickly than is asked for.
constexpr double corner_factor = 4;
/// Number of nodes for each node that divides the outline. If beams are as narrow as triangles, nearly all nodes belong
/// to the outline: it is a node, the midpoint of a side of the outline, and those of sides across the beam.
constexpr double nodes_per_outline_node = 3.5;

/// The corners of a hole or an outline whose solid lies on its left, seen as those of a hole: counterclockwise.
Polygon reversed(Polygon polygon) {
  std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

SizeField size_field(const std::vector<SolidFace>& faces, double beam_width, const MeshOptions& options) {
  SizeField size(options, beam_width);
  for (const SolidFace& face : faces)
    for (const Polygon& polygon : face) size.add_corners(reversed(polygon));
  size.index_corners();
  return size;
}

/// The polygon with the points that divide its sides.
Polygon divided_polygon(const Polygon& polygon, const SizeField& size) {
  Polygon result;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    result.push_back(polygon[k]);
    for (const Eigen::Vector2d& p : size.divide(polygon[k], polygon[(k + 1) % polygon.size()])) result.push_back(p);
  }
  return result;
}

}  // namespace

PartMeshEstimate estimate_part_mesh(const std::vector<SolidFace>& faces, double beam_width,
                                    const MeshOptions& options) {
  check_mesh_options(options);
  const SizeField size = size_field(faces, beam_width, options);
  double solid_area = 0, outline_length = 0;
  for (const SolidFace& face : faces)
    for (const Polygon& polygon : face) {
      solid_area += area(polygon);
      outline_length += perimeter(polygon);
    }
  PartMeshEstimate estimate;
  estimate.nodes = area_factor * size.expected_nodes(solid_area, 0) +
                   corner_factor * size.expected_nodes(0, static_cast<double>(size.corners()));
  double outline_nodes = outline_length / size.max_size();
  // The outline is divided only if it does not have too many nodes anyway, since that takes as much memory.
  if (estimate.nodes + nodes_per_outline_node * outline_nodes <= options.max_nodes) {
    outline_nodes = 0;
    for (const SolidFace& face : faces)
      for (const Polygon& polygon : face) outline_nodes += static_cast<double>(divided_polygon(polygon, size).size());
  }
  estimate.nodes += nodes_per_outline_node * outline_nodes;
  estimate.bytes = estimate.nodes * (bytes_per_node + factor_bytes_per_node * std::log2(std::max(estimate.nodes, 2.0)));
  return estimate;
}

PeriodicMesh make_part_mesh(const std::vector<SolidFace>& faces, double beam_width, const MeshOptions& options) {
  const PartMeshEstimate estimate = estimate_part_mesh(faces, beam_width, options);
  check_number_of_nodes(estimate.nodes, options, "would have about");
  const SizeField size = size_field(faces, beam_width, options);
  std::vector<meshing::PlanarFace> divided_faces;
  Eigen::Vector2d lower = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d upper = -lower;
  double outline_length = 0;
  for (const SolidFace& face : faces) {
    meshing::PlanarFace& divided_face = divided_faces.emplace_back();
    for (const Polygon& polygon : face) {
      divided_face.push_back(divided_polygon(polygon, size));
      outline_length += perimeter(polygon);
      for (const Eigen::Vector2d& p : polygon) {
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
      }
    }
  }
  meshing::PlanarMesh planar = triangulate(divided_faces, size);
  TriangleSoup soup;
  soup.points = std::move(planar.points);
  soup.triangles = std::move(planar.triangles);
  soup.seam.assign(soup.points.size(), 0);
  PeriodicMesh mesh = wrap(soup, Eigen::Matrix2d((part_cell_ratio * (upper - lower)).asDiagonal()), outline_length);
  mesh.mesh_size = size.max_size();
  mesh.beam_width = beam_width;
  check_number_of_nodes(static_cast<double>(mesh.nodes.cols()), options, "has");
  return mesh;
}

PeriodicMesh mesh_part(const std::vector<SolidFace>& faces, double beam_width, const MeshOptions& options,
                       const Execution& execution) {
  execution.cancellation.throw_if_requested();
  const PartMeshEstimate estimate = estimate_part_mesh(faces, beam_width, options);
  check_number_of_nodes(estimate.nodes, options, "would have about");
  const auto helpers = helper_processes();
  if (!helpers) return make_part_mesh(faces, beam_width, options);
  ByteWriter request;
  write(request, faces);
  request.number(beam_width);
  write(request, options);
  const std::string answer = run_task(*helpers, part_mesh_task, request.take(), execution);
  ByteReader reader(answer);
  return read_mesh(reader);
}

void add_part_mesh_task(HelperTasks& tasks) {
  tasks.emplace(part_mesh_task, [](std::string_view request) {
    ByteReader reader(request);
    const std::vector<SolidFace> faces = read_faces(reader);
    const double beam_width = reader.number<double>();
    ByteWriter answer;
    write(answer, make_part_mesh(faces, beam_width, read_mesh_options(reader)));
    return answer.take();
  });
}

}  // namespace supple::tiling
