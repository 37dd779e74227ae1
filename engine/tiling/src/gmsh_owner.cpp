#include "gmsh_owner.h"

#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

#include "polygon.h"
#include "supple/base/error.h"
#include "supple/base/process_random.h"

namespace supple::tiling {
namespace {

/// gmsh's numbers of its algorithms, in the order in which they are tried.
constexpr std::array<int, 3> algorithms = {6 /* frontal Delaunay */, 5 /* Delaunay */, 1 /* MeshAdapt */};

/// A mesh fills its faces if the areas agree to this relative error.
constexpr double area_tolerance = 1e-9;

/// Points inside are rounded to multiples of this, mm: far above rounding errors, far below any length that matters.
/// gmsh's containers are in the order of addresses in memory, on which other threads have influence; the same mesh
/// comes with other last bits and in another order from call to call.
constexpr double grid = 0x1p-32;

class GmshOwner {
 public:
  static GmshOwner& instance() {
    static GmshOwner owner;
    return owner;
  }

  GmshOwner(const GmshOwner&) = delete;
  GmshOwner& operator=(const GmshOwner&) = delete;

  PlanarMesh triangulate(const std::vector<Face>& faces, const std::function<double(const Eigen::Vector2d&)>& size) {
    const auto random = own_process_random();
    const std::lock_guard lock(mutex_);
    std::string messages;
    for (const int algorithm : algorithms) {
      try {
        const Model model;
        gmsh::option::setNumber("Mesh.Algorithm", algorithm);
        gmsh::model::mesh::setSizeCallback(
            [&size](int, int, double x, double y, double) { return size(Eigen::Vector2d(x, y)); });
        add(faces);
        gmsh::model::mesh::generate(2);
        PlanarMesh mesh = read(faces);
        if (fills(mesh, faces)) return mesh;
        messages += message(algorithm, "the triangles do not fill the region");
      } catch (const std::out_of_range&) {  // an element of nodes that were not listed
        messages += message(algorithm, "the mesh is incomplete");
      } catch (...) {  // outside of its parallel regions gmsh throws strings, integers and exceptions
        messages += message(algorithm, "no mesh");
      }
    }
    throw Error("tiling.meshing_failed", "The structure could not be meshed." + messages, {{"parameters", messages}});
  }

 private:
  GmshOwner() {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    // Not to throw: gmsh meshes within a parallel region of OpenMP, which no exception leaves alive.
    gmsh::option::setNumber("General.AbortOnError", 0);
    // General.NumThreads would only count for the thread that sets it, and for whatever else it runs by OpenMP.
    for (const char* dimension : {"1D", "2D", "3D"}) {
      gmsh::option::setNumber(std::string("Mesh.MaxNumThreads") + dimension, 1);
    }
    gmsh::option::setNumber("Mesh.RandomFactor", 1e-9);
    gmsh::option::setNumber("Mesh.RandomSeed", 1);
    gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
    gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 1);
  }
  ~GmshOwner() { gmsh::finalize(); }

  /// An empty model that is current while this object lives.
  struct Model {
    Model() { gmsh::model::add("supple"); }
    ~Model() {
      gmsh::model::mesh::removeSizeCallback();
      gmsh::model::remove();
    }
    Model(const Model&) = delete;
    Model& operator=(const Model&) = delete;
  };

  static std::string message(int algorithm, const char* outcome) {
    std::string last;
    gmsh::logger::getLastError(last);
    return " Algorithm " + std::to_string(algorithm) + ": " + outcome + (last.empty() ? "" : " (" + last + ")") + ".";
  }

  // One point for each vertex, tagged from 1 in their order, and one line without inner nodes for each side.
  static void add(const std::vector<Face>& faces) {
    int points = 0;
    for (const Face& face : faces) {
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

  static double rounded(double coordinate) { return std::round(coordinate / grid) * grid; }

  static PlanarMesh read(const std::vector<Face>& faces) {
    std::size_t boundary = 0;
    for (const Face& face : faces) {
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
    sort(mesh, boundary);
    return mesh;
  }

  /// Points inside by their coordinates, triangles by their points, of which the first has the least number.
  static void sort(PlanarMesh& mesh, std::size_t boundary) {
    std::vector<int> order(mesh.points.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(boundary), order.end(), [&mesh](int a, int b) {
      const Eigen::Vector2d &p = mesh.points[a], &q = mesh.points[b];
      return p.x() != q.x() ? p.x() < q.x() : p.y() < q.y();
    });
    std::vector<Eigen::Vector2d> points;
    std::vector<int> place(order.size());
    for (const int k : order) {
      place[k] = static_cast<int>(points.size());
      points.push_back(mesh.points[k]);
    }
    mesh.points = std::move(points);
    for (std::array<int, 3>& triangle : mesh.triangles) {
      for (int& corner : triangle) corner = place[corner];
      std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
    }
    std::sort(mesh.triangles.begin(), mesh.triangles.end());
  }

  static bool fills(const PlanarMesh& mesh, const std::vector<Face>& faces) {
    double wanted = 0, filled = 0;
    for (const Face& face : faces) {
      for (std::size_t k = 0; k < face.size(); ++k) wanted += (k == 0 ? 1 : -1) * std::abs(area(face[k]));
    }
    for (const auto& [a, b, c] : mesh.triangles) {
      const double twice = cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]);
      if (twice <= 0) return false;
      filled += twice / 2;
    }
    return wanted > 0 && std::abs(filled - wanted) <= area_tolerance * wanted;
  }

  std::mutex mutex_;
};

}  // namespace

PlanarMesh triangulate(const std::vector<Face>& faces, const std::function<double(const Eigen::Vector2d&)>& size) {
  return GmshOwner::instance().triangulate(faces, size);
}

}  // namespace supple::tiling
