#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/execution.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// Maximum magnitude of coordinates (mesh units). Squared areas would overflow above it.
constexpr double max_coordinate = 1e70;
/// Minimum area of faces (mesh units squared). Squared areas would underflow below it.
constexpr double min_area = 1e-140;

/// Collects the faulty elements of one kind, and throws them as one Error with details of the first 20.
class FaultList {
 public:
  static constexpr std::int64_t max_detailed = 20;

  /// Counts a fault. `describe` returns its Error::Detail, and is called for the first 20 faults only.
  template <typename Describe>
  void add(Describe&& describe) {
    if (count_++ < max_detailed) details_.push_back(describe());
  }
  /// Throws an error of this type and code with the message "<count> <plural>." if there is any fault, as in "7 faces
  /// are degenerate". For one fault the message has `singular` instead.
  template <class Thrown = Error>
  void throw_if_any(const std::string& code, const std::string& singular, const std::string& plural) {
    if (count_ > 0) throw Thrown(code, sentence(singular, plural), std::move(details_));
  }

 private:
  std::string sentence(const std::string& singular, const std::string& plural) const;

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
/// Sets vertices that no face uses to 0 if their coordinates are not finite or too large, because they are no reason to
/// refuse a surface. Returns their number. O(n).
std::int64_t reset_unused_vertices(std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces);
std::string unused_vertices_warning(std::int64_t count);
/// Throws "mesh.non_finite". O(n).
void check_coordinates(const std::vector<Eigen::Vector3d>& positions, const Execution& execution = {});
/// Whether a face repeats a vertex or has no area in double precision. Its vertices must exist.
bool is_degenerate(const std::vector<Eigen::Vector3d>& positions, const Triangle& face);
/// Throws "mesh.degenerate_face". O(n).
void check_areas(const std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces,
                 const Execution& execution = {});

}  // namespace supple::surface
