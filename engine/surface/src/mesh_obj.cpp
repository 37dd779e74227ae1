#include <algorithm>
#include <limits>

#include "mesh_reading.h"

namespace supple::surface {
namespace {

/// Statements of the OBJ format (Wavefront, appendix B1) that do not concern triangles.
constexpr std::string_view ignored_statements[] = {
    "vt",     "vn",    "vp",       "g",        "s",     "o",          "mg",        "usemtl", "mtllib", "usemap",
    "maplib", "bevel", "c_interp", "d_interp", "lod",   "shadow_obj", "trace_obj", "cstype", "deg",    "bmat",
    "step",   "curv",  "curv2",    "surf",     "parm",  "trim",       "hole",      "scrv",   "sp",     "end",
    "con",    "call",  "csh",      "ctech",    "stech", "bsp",        "bzp",       "cdc",    "cdp",    "res"};

constexpr std::string_view skipped_elements[] = {"l", "p"};

Eigen::Vector3d read_position(TextScanner& scanner) {
  Eigen::Vector3d p;
  for (int i = 0; i < 3; ++i) p[i] = scanner.number(scanner.statement_token(), "a coordinate");
  // A weight or a colour may follow. Anything else shows that the line is malformed.
  for (auto token = scanner.statement_token(); !token.empty(); token = scanner.statement_token())
    scanner.check_number(token, "a number or the end of the line");
  return p;
}

/// Checks what follows a vertex number: the numbers of a texture coordinate and a normal, as in "/1/3" or "//3".
void check_rest_of_corner(const TextScanner& scanner, std::string_view corner, std::string_view rest) {
  int parts = 0;
  char previous = '/';
  for (const char c : rest) {
    const bool digit = c >= '0' && c <= '9';
    if (!digit) {
      const bool begins_number = c != '/' && previous == '/', after_sign = previous == '-' || previous == '+';
      parts += c == '/';
      if ((c == '/' && after_sign) || (c != '/' && !(begins_number && (c == '-' || c == '+')))) {
        throw_malformed_line(scanner.line_number(),
                             "expected numbers of a texture coordinate and a normal, found " + in_quotes(corner));
      }
    }
    previous = c;
  }
  if (parts > 2) throw_malformed_line(scanner.line_number(), "expected at most three numbers in " + in_quotes(corner));
}

/// The vertex, counted from 0, of a corner such as "7", "7/1", "7//3", "7/1/3" or "-2/...".
std::int32_t read_corner(const TextScanner& scanner, std::string_view token, std::int64_t vertices_so_far) {
  std::size_t end = 0;
  while (end < token.size() && token[end] != '/') ++end;
  const std::string_view first = token.substr(0, end);
  const std::int64_t number = scanner.integer(first, "a vertex number");
  const std::int64_t v = number > 0 ? number - 1 : vertices_so_far + number;
  if (number == 0 || v < 0 || v > std::numeric_limits<std::int32_t>::max()) {
    throw_malformed_line(scanner.line_number(), "vertex number " + std::to_string(number) + " does not exist; " +
                                                    std::to_string(vertices_so_far) + " vertices precede this line");
  }
  if (end < token.size()) check_rest_of_corner(scanner, token, token.substr(end));
  return static_cast<std::int32_t>(v);
}

}  // namespace

TriangleSoup read_obj(std::string_view bytes, const MeshLimits& limits, const Execution& execution) {
  TextScanner scanner(without_byte_order_mark(bytes));
  SoupBuilder builder(limits, execution);
  std::vector<std::int32_t> corners;
  std::int64_t skipped = 0;
  StopPace pace(execution.cancellation);
  while (scanner.next_line()) {
    pace.check();
    scanner.cut_comment();
    const std::string_view word = scanner.statement_token();
    if (word.empty()) continue;
    if (word == "v") {
      builder.add_vertex(read_position(scanner));
    } else if (word == "f" || word == "fo") {
      corners.clear();
      for (auto token = scanner.statement_token(); !token.empty(); token = scanner.statement_token())
        corners.push_back(read_corner(scanner, token, builder.vertex_count()));
      builder.add_polygon(corners);
    } else if (std::ranges::count(skipped_elements, word) > 0) {
      ++skipped;
      scanner.skip_statement();
    } else if (std::ranges::count(ignored_statements, word) == 0) {
      throw_malformed_line(scanner.line_number(), "expected an OBJ statement such as v or f, found " + in_quotes(word));
    } else {
      scanner.skip_statement();
    }
  }
  if (skipped > 0) builder.add_warning(std::to_string(skipped) + " line or point elements were left out.");
  return std::move(builder).finish();
}

}  // namespace supple::surface
