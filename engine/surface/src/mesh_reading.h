#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

/// Throws "mesh.malformed" at "line <line>" or "byte <offset>".
[[noreturn]] void throw_malformed_line(std::int64_t line, const std::string& message);
[[noreturn]] void throw_malformed_byte(std::size_t offset, const std::string& message);
/// The text in quotes, shortened, with everything but printable ASCII replaced: fit for a message whatever it is.
std::string quoted(std::string_view text);
std::string_view without_byte_order_mark(std::string_view bytes);

/// Steps through the lines and the blank-separated tokens of a text. Lines end with LF, CR or CR LF.
class TextScanner {
 public:
  /// `lines_before` precede the text in its file and count in line_number.
  explicit TextScanner(std::string_view text, std::int64_t lines_before = 0)
      : rest_(text), line_number_(lines_before) {}

  /// Moves to the next line; false at the end of the text.
  bool next_line();
  /// The next token of the current line, empty at its end.
  std::string_view token();
  /// The next token of this line or those that follow, empty at the end of the text.
  std::string_view token_across_lines();
  /// Drops the comment that "#" begins in what remains of the current line. The "#" of "-1.#IND" begins none: by such
  /// words the C library of Microsoft writes numbers that are not finite.
  void cut_comment();
  /// The next token of a statement that goes on in the next line where a line ends with a backslash; empty at its end.
  std::string_view statement_token() {
    if (continues_) return continued_token();
    const std::string_view found = token();
    return found.empty() || found.back() != '\\' ? found : token_before_backslash(found);
  }
  /// Skips the lines into which the current statement goes on.
  void skip_statement();

  std::int64_t line_number() const { return line_number_; }
  /// What follows the current line.
  std::string_view rest() const { return rest_; }

  /// The token as a number. "nan", "inf", "nan(ind)", "-1.#IND", "1.#QNAN" and "1.#INF" are numbers that are not
  /// finite: the mesh check names the vertex that has them.
  double number(std::string_view token, std::string_view what) const;
  std::int64_t integer(std::string_view token, std::string_view what) const;

 private:
  std::string_view continued_token();
  std::string_view token_before_backslash(std::string_view found);

  std::string_view rest_;
  std::int64_t line_number_;
  std::string_view line_;
  bool continues_ = false;  ///< whether statement_token has met the backslash at the end of the current line
};

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
