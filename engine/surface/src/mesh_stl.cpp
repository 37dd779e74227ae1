#include <bit>
#include <cstring>

#include "equal_points.h"
#include "mesh_reading.h"
#include "supple/base/error.h"

namespace supple::surface {
namespace {

constexpr std::size_t header_size = 84;  // 80 free bytes and the number of facets
constexpr std::size_t facet_size = 50;   // normal and corners as 12 floats, 2 bytes of attributes

std::uint32_t little_endian_u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

std::uint32_t announced_facets(std::string_view bytes) { return little_endian_u32(bytes, header_size - 4); }

/// Joins equal corners. Three corners make a face.
TriangleSoup join_corners(const std::vector<Eigen::Vector3d>& corners, SoupBuilder builder) {
  const std::vector<std::int32_t> first = first_equal_points(corners, builder.execution());
  std::vector<std::int32_t> numbers(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (first[i] == static_cast<std::int32_t>(i)) {
      numbers[i] = static_cast<std::int32_t>(builder.vertex_count());
      builder.add_vertex(corners[i]);
    } else {
      numbers[i] = numbers[first[i]];
    }
  }
  for (std::size_t i = 0; i < corners.size(); i += 3) builder.add_polygon(std::span(numbers).subspan(i, 3));
  return std::move(builder).finish();
}

TriangleSoup read_binary(std::string_view bytes, const MeshLimits& limits, const Execution& execution) {
  if (bytes.size() < header_size) {
    throw_malformed_byte(bytes.size(), "expected the 84 bytes of a binary STL header");
  }
  const std::uint32_t facets = announced_facets(bytes);
  SoupBuilder builder(limits, execution);
  builder.check_announced(0, facets);
  const std::size_t present = (bytes.size() - header_size) / facet_size;
  if (present < facets) {
    throw_malformed_byte(bytes.size(), "expected facet " + std::to_string(present) + " of " + std::to_string(facets));
  }
  if (bytes.size() > header_size + facet_size * facets) {
    builder.add_warning("The " + std::to_string(bytes.size() - header_size - facet_size * facets) +
                        " bytes after the last facet were left out.");
  }
  std::vector<Eigen::Vector3d> corners;
  corners.reserve(3 * static_cast<std::size_t>(facets));
  StopPace pace(execution.cancellation);
  for (std::size_t facet = 0; facet < facets; ++facet) {
    pace.look();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t at = header_size + facet * facet_size + 12 * (corner + 1);
      corners.emplace_back(std::bit_cast<float>(little_endian_u32(bytes, at)),
                           std::bit_cast<float>(little_endian_u32(bytes, at + 4)),
                           std::bit_cast<float>(little_endian_u32(bytes, at + 8)));
    }
  }
  return join_corners(corners, std::move(builder));
}

void expect(const TextScanner& scanner, std::string_view found, std::string_view word) {
  if (found == word) return;
  throw_malformed_line(scanner.line_number(), "expected " + std::string(word) + ", found " + quoted(found));
}

TriangleSoup read_ascii(std::string_view bytes, const MeshLimits& limits, const Execution& execution) {
  TextScanner scanner(without_byte_order_mark(bytes));
  SoupBuilder builder(limits, execution);
  std::vector<Eigen::Vector3d> corners;
  bool inside_solid = false;
  StopPace pace(execution.cancellation);
  for (std::string_view word = scanner.token_across_lines(); !word.empty(); word = scanner.token_across_lines()) {
    pace.look();
    if (!inside_solid) {
      expect(scanner, word, "solid");
      inside_solid = true;
      scanner.next_line();  // what remains of this line is the solid's name
    } else if (word == "endsolid") {
      inside_solid = false;
      scanner.next_line();
    } else {
      expect(scanner, word, "facet");
      builder.check_announced(0, static_cast<std::int64_t>(corners.size() / 3 + 1));
      expect(scanner, scanner.token_across_lines(), "normal");
      for (int i = 0; i < 3; ++i) scanner.number(scanner.token_across_lines(), "a normal's coordinate");
      expect(scanner, scanner.token_across_lines(), "outer");
      expect(scanner, scanner.token_across_lines(), "loop");
      for (int corner = 0; corner < 3; ++corner) {
        expect(scanner, scanner.token_across_lines(), "vertex");
        Eigen::Vector3d p;
        for (int i = 0; i < 3; ++i) p[i] = scanner.number(scanner.token_across_lines(), "a coordinate");
        corners.push_back(p);
      }
      expect(scanner, scanner.token_across_lines(), "endloop");
      expect(scanner, scanner.token_across_lines(), "endfacet");
    }
  }
  if (inside_solid) throw_malformed_line(scanner.line_number(), "expected endsolid, found the end of the file");
  return join_corners(corners, std::move(builder));
}

}  // namespace

bool is_binary_stl(std::string_view bytes) {
  return bytes.size() >= header_size && bytes.size() == header_size + facet_size * announced_facets(bytes);
}

TriangleSoup read_stl(std::string_view bytes, const MeshLimits& limits, const Execution& execution) {
  const bool is_text = without_byte_order_mark(bytes).starts_with("solid") && !is_binary_stl(bytes);
  return is_text ? read_ascii(bytes, limits, execution) : read_binary(bytes, limits, execution);
}

}  // namespace supple::surface
