#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "equal_points.h"
#include "mesh_reading.h"
#include "supple/base/error.h"

namespace supple::surface {
namespace {

constexpr std::size_t header_size = 84;  // 80 free bytes and the number of facets
constexpr std::size_t facet_size = 50;   // normal and corners as 12 floats, 2 bytes of attributes

std::uint32_t little_endian_u32(std::string_view bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[offset + i]);
  return value;
}

std::uint32_t announced_facets(std::string_view bytes) { return little_endian_u32(bytes, header_size - 4); }

/// Merges equal corners to vertices. Three successive corners form a face.
TriangleSoup join_corners(const std::vector<Eigen::Vector3d>& corners, SoupBuilder builder) {
  const std::vector<std::int32_t> first = first_equal_points(corners, builder.execution());
  std::vector<std::int32_t> vertex_of_corner(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (first[i] == static_cast<std::int32_t>(i)) {
      vertex_of_corner[i] = static_cast<std::int32_t>(builder.vertex_count());
      builder.add_vertex(corners[i]);
    } else {
      vertex_of_corner[i] = vertex_of_corner[first[i]];
    }
  }
  for (std::size_t i = 0; i < corners.size(); i += 3) builder.add_polygon(std::span(vertex_of_corner).subspan(i, 3));
  return std::move(builder).finish();
}

TriangleSoup read_binary(std::string_view bytes, const MeshLimits& limits, const Execution& execution) {
  if (bytes.size() < header_size) {
    throw_malformed_byte(bytes.size(), "expected the 84 bytes of a binary STL header");
  }
  const std::uint32_t facets = announced_facets(bytes);
  SoupBuilder builder(limits, execution);
  const std::size_t present = (bytes.size() - header_size) / facet_size;
  if (present < facets) {
    throw_malformed_byte(bytes.size(), "expected facet " + std::to_string(present) + " of " + std::to_string(facets) +
                                           ", found the end of the file, which is read as binary since it does not "
                                           "begin with the word solid and text");
  }
  builder.check_announced(0, facets);
  if (present > facets) {
    throw_malformed_byte(header_size - 4, "the header announces " + std::to_string(facets) + " facets, but " +
                                              std::to_string(present) + " would fit into the file");
  }
  if (bytes.size() > header_size + facet_size * facets) {
    builder.add_warning("The " + std::to_string(bytes.size() - header_size - facet_size * facets) +
                        " bytes after the last facet were left out.");
  }
  std::vector<Eigen::Vector3d> corners;
  corners.reserve(3 * static_cast<std::size_t>(facets));
  StopPace pace(execution.cancellation);
  for (std::size_t facet = 0; facet < facets; ++facet) {
    pace.check();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t offset = header_size + facet * facet_size + 12 * (corner + 1);
      corners.emplace_back(std::bit_cast<float>(little_endian_u32(bytes, offset)),
                           std::bit_cast<float>(little_endian_u32(bytes, offset + 4)),
                           std::bit_cast<float>(little_endian_u32(bytes, offset + 8)));
    }
  }
  return join_corners(corners, std::move(builder));
}

/// Whether `found` is `word` (given in lower case), in lower case or capitals.
bool is_word(std::string_view found, std::string_view word) {
  return std::equal(found.begin(), found.end(), word.begin(), word.end(), [](char c, char lower_case) {
    return c == lower_case || (c >= 'A' && c <= 'Z' && c - 'A' + 'a' == lower_case);
  });
}

void expect(const TextScanner& scanner, std::string_view found, std::string_view word) {
  if (is_word(found, word)) return;
  throw_malformed_line(scanner.line_number(), "expected " + std::string(word) + ", found " + in_quotes(found));
}

/// The next word outside of comments, which are whole lines. It is empty at the end of the text.
std::string_view next_word(TextScanner& scanner) {
  std::string_view word = scanner.token_across_lines();
  while (word.starts_with("#") || word.starts_with(";") || word.starts_with("!") || word.starts_with("//")) {
    scanner.next_line();
    word = scanner.token_across_lines();
  }
  return word;
}

/// Reads the facets of an ASCII file.
class AsciiReader {
 public:
  AsciiReader(std::string_view bytes, const MeshLimits& limits, const Execution& execution)
      : scanner_(without_byte_order_mark(bytes)), builder_(limits, execution), pace_(execution.cancellation) {}

  TriangleSoup read() && {
    bool inside_solid = false;
    for (std::string_view word = next(); !word.empty(); word = next()) {
      pace_.check();
      if (!inside_solid) {
        expect(scanner_, word, "solid");
        inside_solid = true;
        skip_name();
      } else if (is_word(word, "endsolid")) {
        inside_solid = false;
        scanner_.next_line();
      } else {
        read_facet(word);
      }
    }
    if (inside_solid) throw_malformed_line(scanner_.line_number(), "expected endsolid, found the end of the file");
    return join_corners(corners_, std::move(builder_));
  }

 private:
  std::string_view next() { return pending_.empty() ? next_word(scanner_) : std::exchange(pending_, {}); }

  /// Skips the solid's name, which is the rest of the line. A first facet on the same line is not skipped.
  void skip_name() {
    std::string_view word = scanner_.token(), previous;
    while (!word.empty() && !(is_word(previous, "facet") && is_word(word, "normal"))) {
      previous = word;
      word = scanner_.token();
    }
    facet_begun_ = !word.empty();
    if (facet_begun_) pending_ = previous;
  }

  void read_facet(std::string_view word) {
    expect(scanner_, word, "facet");
    builder_.check_announced(0, static_cast<std::int64_t>(corners_.size() / 3 + 1));
    if (!std::exchange(facet_begun_, false)) expect(scanner_, next(), "normal");
    for (int i = 0; i < 3; ++i) scanner_.number(next(), "a normal's coordinate");
    expect(scanner_, next(), "outer");
    expect(scanner_, next(), "loop");
    for (int corner = 0; corner < 3; ++corner) {
      expect(scanner_, next(), "vertex");
      Eigen::Vector3d p;
      for (int i = 0; i < 3; ++i) p[i] = scanner_.number(next(), "a coordinate");
      corners_.push_back(p);
    }
    expect(scanner_, next(), "endloop");
    expect(scanner_, next(), "endfacet");
  }

  TextScanner scanner_;
  SoupBuilder builder_;
  StopPace pace_;
  std::vector<Eigen::Vector3d> corners_;
  std::string_view pending_;  ///< a word that was read in advance
  bool facet_begun_ = false;  ///< whether "facet normal" was read with the solid's name
};

/// Whether no control character is near the beginning. Nearly every binary file has one in its header.
bool looks_like_text(std::string_view bytes) {
  const std::string_view beginning = bytes.substr(0, 512);
  return std::all_of(beginning.begin(), beginning.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 || (byte >= 0x09 && byte <= 0x0d);
  });
}

}  // namespace

bool is_binary_stl(std::string_view bytes) {
  return bytes.size() >= header_size && bytes.size() == header_size + facet_size * announced_facets(bytes);
}

bool begins_with_solid(std::string_view bytes) {
  TextScanner scanner(without_byte_order_mark(bytes));
  return is_word(next_word(scanner), "solid");
}

TriangleSoup read_stl(std::string_view bytes, const MeshLimits& limits, const Execution& execution) {
  const bool is_text = !is_binary_stl(bytes) && begins_with_solid(bytes) && looks_like_text(bytes);
  return is_text ? AsciiReader(bytes, limits, execution).read() : read_binary(bytes, limits, execution);
}

}  // namespace supple::surface
