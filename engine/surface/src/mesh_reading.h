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

/// Functions that read the formats. All throw what read_mesh describes.
TriangleSoup read_obj(std::string_view bytes, const MeshLimits& limits, const Execution& execution);
TriangleSoup read_off(std::string_view bytes, const MeshLimits& limits, const Execution& execution);
TriangleSoup read_ply(std::string_view bytes, const MeshLimits& limits, const Execution& execution);
TriangleSoup read_stl(std::string_view bytes, const MeshLimits& limits, const Execution& execution);
/// Whether the size of the bytes is exactly that of a binary STL file with the announced number of facets.
bool is_binary_stl(std::string_view bytes);
/// Whether the first word after blank lines and comments (lines that begin with #, ;, ! or //) is "solid", in lower
/// case or capitals. The file is then ASCII STL, or binary STL whose header begins with this word.
bool begins_with_solid(std::string_view bytes);

/// The first word of an OFF file.
struct OffKeyword {
  int extra_numbers = 0;    ///< count of numbers after each vertex' position: texture coordinates, a colour, a normal
  std::string_view suffix;  ///< the rest of the word, as in "OFF4"; often empty
};
/// Empty if the word is no keyword of an OFF file in three dimensions.
std::optional<OffKeyword> read_off_keyword(std::string_view word);

/// Throws "mesh.malformed" at "byte 0" for text in UTF-16 or UTF-32, and for files of other kinds such as ZIP, glTF or
/// STEP. The message names the kind.
void refuse_foreign_files(std::string_view bytes);

/// Collects vertices and polygons within the limits.
class SoupBuilder {
 public:
  /// Checks for a stop request when it gets vertices and polygons, and when it triangulates.
  SoupBuilder(const MeshLimits& limits, const Execution& execution)
      : limits_(limits), execution_(execution), pace_(execution.cancellation) {}

  /// Throws "mesh.too_large" if a file announces more than the limits allow.
  void check_announced(std::int64_t vertices, std::int64_t faces) const;
  void reserve(std::size_t vertices, std::size_t faces);
  void add_vertex(const Eigen::Vector3d& p);
  /// Skips polygons with fewer than three corners. Those with more than three are triangulated by `finish`, because
  /// their vertices may follow later in the file.
  void add_polygon(std::span<const std::int32_t> corners);
  void add_warning(std::string text) { soup_.warnings.push_back(std::move(text)); }

  const Execution& execution() const { return execution_; }
  std::int64_t vertex_count() const { return static_cast<std::int64_t>(soup_.positions.size()); }
  /// The soup with its polygons triangulated (see PolygonCutter), and warnings about them. Throws
  /// "mesh.invalid_polygon", with the numbers that the faces have in the file.
  TriangleSoup finish() &&;

 private:
  /// A polygon with more than three corners. The fan from its first corner represents it until it is triangulated.
  struct Polygon {
    std::int64_t number;  ///< number of the face in the file, from 0
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

/// The number of elements to reserve memory for: the announced count, but at most as many as `bytes` can contain.
std::size_t plausible_count(std::int64_t announced, std::size_t bytes, std::size_t bytes_per_element);

}  // namespace supple::surface
