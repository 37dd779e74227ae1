#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/execution.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// Coordinates beyond this magnitude (mesh units) are refused: squared areas would overflow.
constexpr double largest_coordinate = 1e70;
/// Faces of a smaller area (mesh units squared) are refused: squared areas would underflow.
constexpr double smallest_area = 1e-140;

/// Collects the faulty elements of one kind and throws them as one Error that details the first 20.
class FaultList {
 public:
  static constexpr std::int64_t detailed = 20;

  /// Counts a fault; `describe` returns its Error::Detail and is called for the detailed ones only.
  template <typename Describe>
  void add(Describe&& describe) {
    if (count_++ < detailed) details_.push_back(describe());
  }
  /// Throws Error `code` with the sentence "<count> <what>." if there is any fault. `what` follows a count, as in
  /// "faces are degenerate"; `what_one` is the same for one.
  void throw_if_any(const std::string& code, const std::string& what_one, const std::string& what);

 private:
  std::int64_t count_ = 0;
  std::vector<Error::Detail> details_;
};

std::string name_of_vertex(std::int32_t v);
std::string name_of_face(std::int64_t f);
/// "edge a b" with the smaller vertex first.
std::string name_of_edge(std::int32_t a, std::int32_t b);

/// Throws "mesh.empty", "mesh.too_large", "mesh.non_finite", "mesh.index_out_of_range". O(n).
void check_references(const std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces,
                      const Execution& execution = {});
/// Gives vertices that no face uses the coordinates 0 where theirs are not finite or too large, since they are no
/// reason to refuse a surface. Returns their number. O(n).
std::int64_t place_unused_vertices(std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces);
std::string unused_vertices_warning(std::int64_t placed);
/// Throws "mesh.non_finite". O(n).
void check_coordinates(const std::vector<Eigen::Vector3d>& positions, const Execution& execution = {});
/// Whether a face repeats a vertex or has no area in double precision; its vertices exist.
bool is_degenerate(const std::vector<Eigen::Vector3d>& positions, const Triangle& face);
/// Throws "mesh.degenerate_face". O(n).
void check_areas(const std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces,
                 const Execution& execution = {});

}  // namespace supple::surface
