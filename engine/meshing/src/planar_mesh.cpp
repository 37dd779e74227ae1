#include "supple/meshing/planar_mesh.h"

#include <gmsh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

#include "gmsh_owner.h"
#include "supple/base/cancellation.h"
#include "supple/base/error.h"

namespace supple::meshing {
namespace {

/// gmsh's numbers of its algorithms, in the order in which they are tried.
constexpr std::array<int, 3> planar_algorithms = {6 /* frontal Delaunay */, 5 /* Delaunay */, 1 /* MeshAdapt */};

/// A mesh fills its faces if the areas agree to this relative error.
constexpr double area_tolerance = 1e-9;

/// Points inside are rounded to multiples of this, mm: far above rounding errors, far below any length that matters.
/// gmsh's containers are in the order of addresses in memory, which depend on other threads. Therefore its results
/// differ in the last bits and in their order from call to call.
constexpr double planar_grid = 0x1p-32;

using Polygon = std::vector<Eigen::Vector2d>;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The area of a polygon, positive if it runs counterclockwise.
double area(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    // Vectors are relative to the first vertex, so that no digits are lost far from the origin.
    twice += cross(polygon[k] - polygon[0], polygon[(k + 1) % polygon.size()] - polygon[0]);
  }
  return twice / 2;
}

std::string outcome_of(const GmshSession& session, int algorithm, const char* outcome) {
  const std::string last = last_gmsh_error(session);
  return " Algorithm " + std::to_string(algorithm) + ": " + outcome + (last.empty() ? "" : " (" + last + ")") + ".";
}

// Adds one point for each vertex, tagged from 1 in their order, and one line without inner nodes for each side.
void add_faces(const std::vector<PlanarFace>& faces) {
  int points = 0;
  for (const PlanarFace& face : faces) {
    std::vector<int> loops;
    for (const Polygon& polygon : face) {
      const int first = points + 1;
      for (const Eigen::Vector2d& p : polygon) gmsh::model::geo::addPoint(p.x(), p.y(), 0, 0, ++points);
      std::vector<int> lines;
      for (int tag = first; tag <= points; ++tag) {
        lines.push_back(gmsh::model::geo::addLine(tag, tag < points ? tag + 1 : first));
        gmsh::model::geo::mesh::setTransfiniteCurve(lines.back(), 2);
      }
      loops.push_back(gmsh::model::geo::addCurveLoop(lines));
    }
    gmsh::model::geo::addPlaneSurface(loops);
  }
  gmsh::model::geo::synchronize();
}

double rounded(double coordinate) { return std::round(coordinate / planar_grid) * planar_grid; }

/// Sorts the points inside by their coordinates, and the triangles by their points, the smallest of which comes first.
void sort_planar(PlanarMesh& mesh, std::size_t boundary) {
  std::vector<int> order(mesh.points.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin() + static_cast<std::ptrdiff_t>(boundary), order.end(), [&mesh](int a, int b) {
    const Eigen::Vector2d &p = mesh.points[a], &q = mesh.points[b];
    return p.x() != q.x() ? p.x() < q.x() : p.y() < q.y();
  });
  std::vector<Eigen::Vector2d> points;
  std::vector<int> new_index(order.size());
  for (const int k : order) {
    new_index[k] = static_cast<int>(points.size());
    points.push_back(mesh.points[k]);
  }
  mesh.points = std::move(points);
  for (std::array<int, 3>& triangle : mesh.triangles) {
    for (int& corner : triangle) corner = new_index[corner];
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
  }
  std::sort(mesh.triangles.begin(), mesh.triangles.end());
}

PlanarMesh read_planar(const std::vector<PlanarFace>& faces) {
  std::size_t boundary = 0;
  for (const PlanarFace& face : faces) {
    for (const Polygon& polygon : face) boundary += polygon.size();
  }
  PlanarMesh mesh;
  std::unordered_map<std::size_t, int> index;
  const auto add_nodes = [&](int dimension, int tag) {
    std::vector<std::size_t> tags;
    std::vector<double> coordinates, parametric;
    gmsh::model::mesh::getNodes(tags, coordinates, parametric, dimension, tag);
    for (std::size_t k = 0; k < tags.size(); ++k) {
      index.emplace(tags[k], static_cast<int>(mesh.points.size()));
      const double x = coordinates[3 * k], y = coordinates[3 * k + 1];
      mesh.points.emplace_back(dimension == 0 ? x : rounded(x), dimension == 0 ? y : rounded(y));
    }
  };
  for (std::size_t tag = 1; tag <= boundary; ++tag) add_nodes(0, static_cast<int>(tag));
  add_nodes(2, -1);
  std::vector<std::size_t> tags, nodes;
  gmsh::model::mesh::getElementsByType(2, tags, nodes);
  for (std::size_t k = 0; k + 2 < nodes.size(); k += 3) {
    mesh.triangles.push_back({index.at(nodes[k]), index.at(nodes[k + 1]), index.at(nodes[k + 2])});
  }
  sort_planar(mesh, boundary);
  return mesh;
}

bool fills_faces(const PlanarMesh& mesh, const std::vector<PlanarFace>& faces) {
  double wanted = 0, filled = 0;
  for (const PlanarFace& face : faces) {
    for (std::size_t k = 0; k < face.size(); ++k) wanted += (k == 0 ? 1 : -1) * std::abs(area(face[k]));
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    const double twice = cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]);
    if (twice <= 0) return false;
    filled += twice / 2;
  }
  return wanted > 0 && std::abs(filled - wanted) <= area_tolerance * wanted;
}

}  // namespace

PlanarMesh triangulate(const std::vector<PlanarFace>& faces,
                       const std::function<double(const Eigen::Vector2d&)>& size) {
  const GmshSession session;
  std::string messages;
  for (const int algorithm : planar_algorithms) {
    try {
      const GmshModel model(session);
      gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 1);
      gmsh::option::setNumber("Mesh.Renumber", 1);
      gmsh::option::setNumber("Mesh.Algorithm", algorithm);
      gmsh::model::mesh::setSizeCallback(
          [&size](int, int, double x, double y, double) { return size(Eigen::Vector2d(x, y)); });
      add_faces(faces);
      gmsh::model::mesh::generate(2);
      PlanarMesh mesh = read_planar(faces);
      if (fills_faces(mesh, faces)) return mesh;
      messages += outcome_of(session, algorithm, "the triangles do not fill the region");
    } catch (const std::out_of_range&) {  // an element of nodes that were not listed
      messages += outcome_of(session, algorithm, "the mesh is incomplete");
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const Cancelled&) {
      throw;
    } catch (...) {  // outside of its parallel regions gmsh throws strings, integers and exceptions
      messages += outcome_of(session, algorithm, "no mesh");
    }
  }
  throw MeshingFailed("tiling.meshing_failed", "The structure could not be meshed." + messages,
                      {{"parameters", messages}});
}

}  // namespace supple::meshing
