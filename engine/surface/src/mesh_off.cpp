#include <algorithm>
#include <limits>
#include <optional>

#include "mesh_reading.h"
#include "supple/base/error.h"
#include "supple/surface/mesh_error.h"

namespace supple::surface {
namespace {

/// The layout of a file's elements. `lines`: each element begins a line and may continue on the next ones, and a colour
/// may follow it. `words`: line ends have no meaning, as in a file on a single line.
enum class Layout { lines, words };

std::int64_t read_count(const TextScanner& scanner, std::string_view token, const char* what) {
  const std::int64_t count = scanner.integer(token, what);
  if (count < 0) throw_malformed_line(scanner.line_number(), std::string(what) + " is negative");
  return count;
}

/// Reads the words of an OFF file in one of the two layouts.
class OffReader {
 public:
  OffReader(std::string_view bytes, Layout layout, const MeshLimits& limits, const Execution& execution)
      : layout_(layout),
        size_(bytes.size()),
        scanner_(without_byte_order_mark(bytes)),
        builder_(limits, execution),
        pace_(execution.cancellation) {}

  TriangleSoup read() && {
    read_header();
    for (std::int64_t v = 0; v < vertices_; ++v) read_vertex(v);
    for (std::int64_t f = 0; f < faces_; ++f) read_face(f);
    finish();
    return std::move(builder_).finish();
  }

 private:
  /// The next word of this line or the following ones. It is empty at the end of the text; comments are skipped.
  std::string_view word() {
    const std::string_view found = scanner_.token();
    return found.empty() ? word_on_next_lines() : found;
  }

  std::string_view word_on_next_lines() {
    continued_ = continued_ || inside_element_;
    while (scanner_.next_line()) {
      pace_.check();
      scanner_.cut_comment();
      if (const std::string_view found = scanner_.token(); !found.empty()) return found;
    }
    return {};
  }

  void read_header() {
    const std::string_view first = word();
    const std::optional<OffKeyword> keyword = read_off_keyword(first);
    if (!keyword)
      throw_malformed_line(scanner_.line_number(), "expected OFF of three dimensions, found " + in_quotes(first));
    extra_numbers_ = keyword->extra_numbers;
    const std::string_view count = keyword->suffix.empty() ? word() : keyword->suffix;
    if (count == "BINARY") throw_malformed_line(scanner_.line_number(), "binary OFF is not read; write it as text");
    vertices_ = read_count(scanner_, count, "the number of vertices");
    const std::int64_t line = scanner_.line_number();
    faces_ = read_count(scanner_, word(), "the number of faces");
    // The number of edges may be missing at the end of a line.
    const bool one_line = scanner_.line_number() == line;
    if (const std::string_view edges = one_line && layout_ == Layout::lines ? scanner_.token() : word(); !edges.empty())
      scanner_.integer(edges, "the number of edges");
    builder_.check_announced(vertices_, faces_);
    builder_.reserve(plausible_count(vertices_, size_, 6), plausible_count(faces_, size_, 8));
  }

  void read_vertex(std::int64_t v) {
    begin_element();
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i) {
      const std::string_view token = word();
      if (token.empty()) {
        throw_malformed_line(scanner_.line_number(), "expected the coordinates of vertex " + std::to_string(v) +
                                                         " of " + std::to_string(vertices_));
      }
      p[i] = scanner_.number(token, "a coordinate");
      inside_element_ = true;
    }
    if (layout_ == Layout::words) {
      for (int i = 0; i < extra_numbers_; ++i) scanner_.check_number(word(), "a number of a normal or a colour");
    } else {
      dropped_ = (drop_rest_of_line() && extra_numbers_ == 0) || dropped_;
    }
    builder_.add_vertex(p);
  }

  void read_face(std::int64_t f) {
    begin_element();
    const std::string_view token = word();
    if (token.empty()) {
      throw_malformed_line(scanner_.line_number(),
                           "expected face " + std::to_string(f) + " of " + std::to_string(faces_));
    }
    inside_element_ = true;
    const std::int64_t size = read_count(scanner_, token, "the number of corners");
    corners_.clear();
    for (std::int64_t i = 0; i < size; ++i) {
      const std::int64_t v = scanner_.integer(word(), "a vertex number");
      if (v < 0 || v >= vertices_) {
        throw_malformed_line(scanner_.line_number(), "vertex number " + std::to_string(v) +
                                                         " does not exist; there are " + std::to_string(vertices_) +
                                                         " vertices, counted from 0");
      }
      corners_.push_back(static_cast<std::int32_t>(v));
    }
    if (layout_ == Layout::lines) drop_rest_of_line();
    builder_.add_polygon(corners_);
  }

  void begin_element() { inside_element_ = false; }

  /// Drops the colour that may follow. Returns whether there was one.
  bool drop_rest_of_line() {
    bool any = false;
    for (std::string_view token = scanner_.token(); !token.empty(); token = scanner_.token()) {
      scanner_.check_number(token, "a number of a colour or the end of the line");
      any = true;
    }
    return any;
  }

  void finish() {
    inside_element_ = false;
    if (dropped_ && continued_) {
      throw_malformed_line(scanner_.line_number(),
                           "the lines before this one hold neither one vertex or face each nor nothing but them");
    }
    if (word().empty()) return;
    const std::string from = std::to_string(scanner_.line_number());
    if (layout_ == Layout::words || dropped_)
      throw_malformed_line(scanner_.line_number(), "expected the end of the file after the last face");
    builder_.add_warning("What follows the last face, from line " + from + " on, was left out.");
  }

  Layout layout_;
  std::size_t size_;
  TextScanner scanner_;
  SoupBuilder builder_;
  StopPace pace_;
  int extra_numbers_ = 0;
  std::int64_t vertices_ = 0;
  std::int64_t faces_ = 0;
  std::vector<std::int32_t> corners_;
  bool inside_element_ = false;
  bool dropped_ = false;    ///< whether numbers after a vertex were dropped although the keyword does not announce them
  bool continued_ = false;  ///< whether an element continued on another line
};

}  // namespace

std::optional<OffKeyword> read_off_keyword(std::string_view word) {
  // "nOFF" has n dimensions, while "NOFF" has normals. So capitals matter, unless the whole word is in lower case.
  std::string letters(word.substr(0, std::min<std::size_t>(word.size(), 8)));
  const bool is_lower_case = std::none_of(letters.begin(), letters.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
  if (is_lower_case)
    for (char& c : letters) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  std::string_view rest = letters;
  OffKeyword keyword;
  struct Prefix {
    std::string_view letters;
    int numbers;
  };
  for (const Prefix& prefix : {Prefix{"ST", 2}, Prefix{"C", 4}, Prefix{"N", 3}}) {
    if (!rest.starts_with(prefix.letters)) continue;
    rest.remove_prefix(prefix.letters.size());
    keyword.extra_numbers += prefix.numbers;
  }
  if (!rest.starts_with("OFF")) return std::nullopt;
  keyword.suffix = word.substr(letters.size() - rest.size() + 3);
  const bool digits =
      std::all_of(keyword.suffix.begin(), keyword.suffix.end(), [](char c) { return c >= '0' && c <= '9'; });
  return digits ? std::optional(keyword) : std::nullopt;
}

TriangleSoup read_off(std::string_view bytes, const MeshLimits& limits, const Execution& execution) {
  try {
    return OffReader(bytes, Layout::lines, limits, execution).read();
  } catch (const MalformedMesh&) {
    // Most malformed files are malformed in either layout, and then the error of the usual layout is thrown.
    try {
      return OffReader(bytes, Layout::words, limits, execution).read();
    } catch (const MalformedMesh&) {
      // It is malformed in either layout.
    }
    throw;
  }
}

}  // namespace supple::surface
