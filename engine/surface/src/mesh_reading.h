#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_text.h"
#include "supple/base/stop_pace.h"
#include "supple/surface/mesh_io.h"

namespace supple::surface {

/// What the readers of the single formats share. All throw as read_mesh promises.
TriangleSoup read_obj(std::string_view bytes, const MeshLimits& limits, const Execution& execution);
TriangleSoup read_off(std::string_view bytes, const MeshLimits& limits, const Execution& execution);
TriangleSoup read_ply(std::string_view bytes, const MeshLimits& limits, const Execution& execution);
TriangleSoup read_stl(std::string_view bytes, const MeshLimits& limits, const Execution& execution);
/// Whether the bytes have the exact size that their count field gives a binary STL file.
bool is_binary_stl(std::string_view bytes);
/// Whether the first word after blank lines and comments (lines that begin with #, ;, ! or //) is "solid", in small
/// letters or capitals: the file is ASCII STL, or a binary one whose header begins so.
bool begins_with_solid(std::string_view bytes);

/// The first word of an OFF file: what it says of the vertices, and what is glued to it.
struct OffKeyword {
  int further_numbers = 0;  ///< that each vertex has after its position: texture coordinates, a colour, a normal
  std::string_view glued;   ///< the rest of the word, as in "OFF4"; empty for none
};
/// Nothing where the word is no keyword of an OFF file in three dimensions.
std::optional<OffKeyword> read_off_keyword(std::string_view word);

/// Throws "mesh.malformed" at "byte 0" for text in UTF-16 or UTF-32 and for files of other kinds (ZIP, glTF, STEP and
/// the like), and names what they are.
void refuse_foreign_files(std::string_view bytes);

/// Collects vertices and polygons within the limits.
class SoupBuilder {
 public:
  /// Looks for a stop request while it is given vertices and polygons, and while it cuts them.
  SoupBuilder(const MeshLimits& limits, const Execution& execution)
      : limits_(limits), execution_(execution), pace_(execution.cancellation) {}

  /// Throws "mesh.too_large" if a file announces more than the limits allow.
  void check_announced(std::int64_t vertices, std::int64_t faces) const;
  void reserve(std::size_t vertices, std::size_t faces);
  void add_vertex(const Eigen::Vector3d& p);
  /// Skips polygons with fewer than three corners; larger ones are cut into triangles by `finish`, since their vertices
  /// may follow.
  void add_polygon(std::span<const std::int32_t> corners);
  void add_warning(std::string text) { soup_.warnings.push_back(std::move(text)); }

  const Execution& execution() const { return execution_; }
  std::int64_t vertex_count() const { return static_cast<std::int64_t>(soup_.positions.size()); }
  /// The soup with its polygons cut, see PolygonCutter, and the warnings about them. Throws "mesh.invalid_polygon",
  /// which names the faces by their numbers in the file.
  TriangleSoup finish() &&;

 private:
  /// A polygon of more than three corners: until it is cut, the fan from its first corner stands for it.
  struct Polygon {
    std::int64_t number;  ///< of the face in the file, from 0
    std::size_t first_triangle;
    std::size_t corners;
  };
  void cut_polygons();

  MeshLimits limits_;
  const Execution& execution_;
  StopPace pace_;
  TriangleSoup soup_;
  std::int64_t polygons_ = 0;
  std::int64_t skipped_polygons_ = 0;
  std::vector<Polygon> larger_polygons_;
};

/// A count that files write before data, as a number of elements worth reserving: no more than `bytes` could hold.
std::size_t plausible_count(std::int64_t announced, std::size_t bytes, std::size_t bytes_per_element);

}  // namespace supple::surface
