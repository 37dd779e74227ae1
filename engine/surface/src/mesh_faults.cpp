#include "mesh_faults.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "supple/base/stop_pace.h"
#include "supple/surface/mesh_error.h"

namespace supple::surface {
namespace {

std::string triple(const Triangle& face) {
  return std::to_string(face[0]) + ", " + std::to_string(face[1]) + ", " + std::to_string(face[2]);
}

void check_sizes(std::size_t vertices, std::size_t faces) {
  if (vertices == 0) throw MeshSizeError("mesh.empty", "The mesh has no vertices.", {{"vertices", "is empty"}});
  if (faces == 0) throw MeshSizeError("mesh.empty", "The mesh has no faces.", {{"faces", "is empty"}});
  // Halfedges and vertices are numbered by int32.
  constexpr std::size_t limit = std::numeric_limits<std::int32_t>::max() / 3;
  for (const auto& [name, count] : {std::pair{"vertices", vertices}, std::pair{"faces", faces}}) {
    if (count > limit) {
      throw MeshSizeError(
          "mesh.too_large",
          "The mesh has " + std::to_string(count) + " " + name + ", the limit is " + std::to_string(limit) + ".",
          {{name, std::to_string(count) + " is above the limit of " + std::to_string(limit)}});
    }
  }
}

void check_indices(std::int64_t vertices, const std::vector<Triangle>& faces) {
  FaultList faults;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto [low, high] = std::minmax({faces[f][0], faces[f][1], faces[f][2]});
    if (low >= 0 && high < vertices) continue;
    faults.add([&]() -> Error::Detail {
      return {name_of_face(static_cast<std::int64_t>(f)),
              "has the vertices " + triple(faces[f]) + "; they must be in 0 to " + std::to_string(vertices - 1)};
    });
  }
  faults.throw_if_any("mesh.index_out_of_range", "face names a vertex that does not exist",
                      "faces name a vertex that does not exist");
}

// Whether the height above the longest side is below the rounding of the coordinates, or the area underflows.
bool area_vanishes(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d u = b - a, v = c - a;
  const double doubled_area = u.cross(v).norm();
  const double longest = std::sqrt(std::max({u.squaredNorm(), v.squaredNorm(), (c - b).squaredNorm()}));
  const double magnitude = a.cwiseAbs().cwiseMax(b.cwiseAbs()).cwiseMax(c.cwiseAbs()).maxCoeff();
  const double rounding = 2 * std::numeric_limits<double>::epsilon() * (magnitude + longest);
  return !(doubled_area > rounding * longest) || doubled_area < 2 * min_area;
}

bool is_valid(const Eigen::Vector3d& p) { return p.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= max_coordinate; }

bool repeats_vertex(const Triangle& face) { return face[0] == face[1] || face[1] == face[2] || face[2] == face[0]; }

}  // namespace

std::string FaultList::sentence(const std::string& singular, const std::string& plural) const {
  std::string sentence = std::to_string(count_) + " " + (count_ == 1 ? singular : plural);
  if (count_ > max_detailed) sentence += "; the first " + std::to_string(max_detailed) + " are named";
  return sentence + ".";
}

std::string name_of_vertex(std::int32_t v) { return "vertex " + std::to_string(v); }
std::string name_of_face(std::int64_t f) { return "face " + std::to_string(f); }
std::string name_of_edge(std::int32_t a, std::int32_t b) {
  return "edge " + std::to_string(std::min(a, b)) + " " + std::to_string(std::max(a, b));
}

std::int64_t reset_unused_vertices(std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces) {
  std::vector<std::uint8_t> used;
  std::int64_t count = 0;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (is_valid(positions[v])) continue;
    if (used.empty()) {
      used.assign(positions.size(), 0);
      for (const Triangle& face : faces)
        for (const std::int32_t corner : face)
          if (corner >= 0 && static_cast<std::size_t>(corner) < positions.size()) used[corner] = 1;
    }
    if (used[v]) continue;
    positions[v].setZero();
    ++count;
  }
  return count;
}

std::string unused_vertices_warning(std::int64_t count) {
  return std::to_string(count) + (count == 1 ? " vertex that no face uses has" : " vertices that no face uses have") +
         " coordinates that are not finite or too large; they are 0 in the mesh.";
}

void check_coordinates(const std::vector<Eigen::Vector3d>& positions, const Execution& execution) {
  FaultList faults;
  StopPace pace(execution.cancellation);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    pace.check();
    if (is_valid(positions[v])) continue;
    faults.add([&]() -> Error::Detail {
      return {name_of_vertex(static_cast<std::int32_t>(v)), positions[v].allFinite()
                                                                ? "has a coordinate of magnitude above 1e70"
                                                                : "has a coordinate that is not a finite number"};
    });
  }
  faults.throw_if_any("mesh.non_finite", "vertex has a coordinate that is not finite or too large",
                      "vertices have a coordinate that is not finite or too large");
}

void check_references(const std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces,
                      const Execution& execution) {
  check_sizes(positions.size(), faces.size());
  check_coordinates(positions, execution);
  execution.cancellation.throw_if_requested();
  check_indices(static_cast<std::int64_t>(positions.size()), faces);
}

bool is_degenerate(const std::vector<Eigen::Vector3d>& positions, const Triangle& face) {
  return repeats_vertex(face) || area_vanishes(positions[face[0]], positions[face[1]], positions[face[2]]);
}

void check_areas(const std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces,
                 const Execution& execution) {
  FaultList faults;
  StopPace pace(execution.cancellation);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    pace.check();
    if (!is_degenerate(positions, faces[f])) continue;
    faults.add([&]() -> Error::Detail {
      return {name_of_face(static_cast<std::int64_t>(f)),
              (repeats_vertex(faces[f]) ? "repeats a vertex: " : "has no area in double precision; its vertices are ") +
                  triple(faces[f])};
    });
  }
  faults.throw_if_any<RepairableFault>("mesh.degenerate_face", "face is degenerate", "faces are degenerate");
}

}  // namespace supple::surface
