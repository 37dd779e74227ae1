#include <limits>

#include "mesh_reading.h"

namespace supple::surface {
namespace {

/// Moves to the next line that holds more than a comment and returns its first token; empty at the end of the text.
std::string_view next_filled_line(TextScanner& scanner) {
  while (scanner.next_line()) {
    scanner.cut_line_at('#');
    if (const std::string_view token = scanner.token(); !token.empty()) return token;
  }
  return {};
}

std::int64_t read_count(const TextScanner& scanner, std::string_view token, const char* what) {
  const std::int64_t count = scanner.integer(token, what);
  if (count < 0) throw_malformed_line(scanner.line_number(), std::string(what) + " is negative");
  return count;
}

void check_header(const TextScanner& scanner, std::string_view keyword) {
  // Texture coordinates, colours and normals follow the position and are left out.
  for (const std::string_view prefix : {"ST", "C", "N"}) {
    if (keyword.starts_with(prefix)) keyword.remove_prefix(prefix.size());
  }
  if (keyword == "OFF") return;
  throw_malformed_line(scanner.line_number(), "expected OFF of three dimensions, found " + quoted(keyword));
}

}  // namespace

TriangleSoup read_off(std::string_view bytes, const MeshLimits& limits, const Execution& execution) {
  TextScanner scanner(without_byte_order_mark(bytes));
  SoupBuilder builder(limits, execution);
  check_header(scanner, next_filled_line(scanner));
  std::string_view token = scanner.token();
  if (token == "BINARY") throw_malformed_line(scanner.line_number(), "binary OFF is not read; write it as text");
  if (token.empty()) token = next_filled_line(scanner);
  const std::int64_t vertices = read_count(scanner, token, "the number of vertices");
  const std::int64_t faces = read_count(scanner, scanner.token(), "the number of faces");
  builder.check_announced(vertices, faces);
  builder.reserve(plausible_count(vertices, bytes.size(), 6), plausible_count(faces, bytes.size(), 8));

  for (std::int64_t v = 0; v < vertices; ++v) {
    Eigen::Vector3d p;
    token = next_filled_line(scanner);
    for (int i = 0; i < 3; ++i) {
      if (token.empty()) {
        throw_malformed_line(scanner.line_number(), "expected the coordinates of vertex " + std::to_string(v) + " of " +
                                                        std::to_string(vertices));
      }
      p[i] = scanner.number(token, "a coordinate");
      if (i < 2) token = scanner.token();
    }
    builder.add_vertex(p);
  }
  std::vector<std::int32_t> corners;
  for (std::int64_t f = 0; f < faces; ++f) {
    token = next_filled_line(scanner);
    if (token.empty()) {
      throw_malformed_line(scanner.line_number(),
                           "expected face " + std::to_string(f) + " of " + std::to_string(faces));
    }
    const std::int64_t size = read_count(scanner, token, "the number of corners");
    corners.clear();
    for (std::int64_t i = 0; i < size; ++i) {
      const std::int64_t v = scanner.integer(scanner.token(), "a vertex number");
      if (v < 0 || v >= vertices) {
        throw_malformed_line(scanner.line_number(), "vertex number " + std::to_string(v) +
                                                        " does not exist; there are " + std::to_string(vertices) +
                                                        " vertices, counted from 0");
      }
      corners.push_back(static_cast<std::int32_t>(v));
    }
    builder.add_polygon(corners);
  }
  if (!next_filled_line(scanner).empty()) {
    builder.add_warning("What follows the last face, from line " + std::to_string(scanner.line_number()) +
                        " on, was left out.");
  }
  return std::move(builder).finish();
}

}  // namespace supple::surface
