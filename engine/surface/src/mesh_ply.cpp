#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "mesh_reading.h"
#include "supple/base/stop_pace.h"

namespace supple::surface {
namespace {

enum class Encoding { ascii, little_endian, big_endian };
enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string_view name;
  Scalar type;
  std::optional<Scalar> count_type;  // set for lists
};

struct Element {
  std::string_view name;
  std::int64_t count = 0;
  std::vector<Property> properties;

  int find(std::string_view wanted) const {
    for (std::size_t i = 0; i < properties.size(); ++i) {
      if (properties[i].name == wanted) return static_cast<int>(i);
    }
    return -1;
  }
};

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::string_view body;
  std::int64_t lines = 0;
};

std::size_t size_of(Scalar type) {
  switch (type) {
    case Scalar::int8:
    case Scalar::uint8:
      return 1;
    case Scalar::int16:
    case Scalar::uint16:
      return 2;
    case Scalar::float64:
      return 8;
    default:
      return 4;
  }
}

Scalar scalar_type(const TextScanner& scanner, std::string_view name) {
  struct Row {
    std::string_view name;
    Scalar type;
  };
  constexpr Row table[] = {{"char", Scalar::int8},      {"int8", Scalar::int8},       {"uchar", Scalar::uint8},
                           {"uint8", Scalar::uint8},    {"short", Scalar::int16},     {"int16", Scalar::int16},
                           {"ushort", Scalar::uint16},  {"uint16", Scalar::uint16},   {"int", Scalar::int32},
                           {"int32", Scalar::int32},    {"uint", Scalar::uint32},     {"uint32", Scalar::uint32},
                           {"float", Scalar::float32},  {"float32", Scalar::float32}, {"double", Scalar::float64},
                           {"float64", Scalar::float64}};
  for (const Row& row : table) {
    if (row.name == name) return row.type;
  }
  throw_malformed_line(scanner.line_number(), "expected a PLY scalar type, found " + in_quotes(name));
}

Encoding read_encoding(TextScanner& scanner) {
  const std::string_view name = scanner.token(), version = scanner.token();
  if (version != "1.0")
    throw_malformed_line(scanner.line_number(), "expected PLY version 1.0, found " + in_quotes(version));
  if (name == "ascii") return Encoding::ascii;
  if (name == "binary_little_endian") return Encoding::little_endian;
  if (name == "binary_big_endian") return Encoding::big_endian;
  throw_malformed_line(scanner.line_number(), "expected a PLY format, found " + in_quotes(name));
}

Property read_property(TextScanner& scanner) {
  Property property{};
  std::string_view type = scanner.token();
  if (type == "list") {
    property.count_type = scalar_type(scanner, scanner.token());
    type = scanner.token();
  }
  property.type = scalar_type(scanner, type);
  property.name = scanner.token();
  if (property.name.empty()) throw_malformed_line(scanner.line_number(), "expected the property's name");
  return property;
}

Header read_header(std::string_view bytes) {
  TextScanner scanner(bytes);
  Header header;
  bool has_format = false;
  scanner.next_line();
  if (const std::string_view magic = scanner.token(); magic != "ply") {
    throw_malformed_line(1, "expected ply, found " + in_quotes(magic));
  }
  while (scanner.next_line()) {
    const std::string_view word = scanner.token();
    if (word == "end_header") {
      if (!has_format) throw_malformed_line(scanner.line_number(), "the header has no format line");
      header.body = scanner.rest();
      // If lines end with CR alone, an LF after the last one is data.
      const bool cr_alone = bytes.starts_with("ply\r") && !bytes.starts_with("ply\r\n");
      const std::size_t body_at = bytes.size() - header.body.size();
      if (cr_alone && bytes.substr(0, body_at).ends_with("\r\n")) header.body = bytes.substr(body_at - 1);
      header.lines = scanner.line_number();
      return header;
    }
    if (word == "format") {
      header.encoding = read_encoding(scanner);
      has_format = true;
    } else if (word == "element") {
      Element element;
      element.name = scanner.token();
      element.count = scanner.integer(scanner.token(), "the number of elements");
      if (element.count < 0) throw_malformed_line(scanner.line_number(), "the number of elements is negative");
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      if (header.elements.empty()) throw_malformed_line(scanner.line_number(), "a property precedes every element");
      header.elements.back().properties.push_back(read_property(scanner));
    } else if (!word.empty() && word != "comment" && word != "obj_info") {
      throw_malformed_line(scanner.line_number(), "expected a PLY header line, found " + in_quotes(word));
    }
  }
  throw_malformed_line(scanner.line_number(), "the header has no end_header");
}

/// Reads the numbers of an ASCII body.
class TextBody {
 public:
  TextBody(const Header& header, const CancellationToken& cancellation)
      : scanner_(header.body, header.lines), pace_(cancellation) {}

  double number(Scalar) {
    const std::string_view token = scanner_.token_across_lines();
    if (token.empty()) fail("expected a number, found the end of the file");
    const std::int64_t line = scanner_.line_number();
    if (begins_element_) note_beginning(line);
    last_line_ = line;
    return scanner_.number(token, "a number");
  }
  /// Begins a vertex, face or strip, of which `index` is the number in its section.
  void begin_element(std::int64_t index) {
    if (index == 0) begins_lines_ = follows_in_line_ = false;
    begins_section_ = index == 0;
    begins_element_ = true;
  }
  /// Called if something follows the last element. Fails if, in one section, some elements began a line and others
  /// began within one: the lines then contain more numbers for an element than the header announces. The elements in
  /// the section's first line say nothing, because a line may hold the whole section.
  void check_rest() const {
    if (has_mixed_lines_) {
      fail("numbers are left over; the lines hold more of them than the header announces for their elements");
    }
  }
  void skip(const Element& element) {
    for (std::int64_t i = 0; i < element.count && !element.properties.empty(); ++i) {
      for (const Property& property : element.properties) skip_property(property);
    }
  }
  void skip_property(const Property& property) {
    const double values = property.count_type ? number(*property.count_type) : 1;
    if (!(values >= 0 && values < 0x1p53)) fail("the length of a list is not a number from 0 to 2^53");
    for (std::int64_t i = static_cast<std::int64_t>(values); i > 0; --i) {
      check_for_stop();
      number(property.type);
    }
  }
  /// Called for each value of a list, and for each value that is skipped.
  void check_for_stop() { pace_.check(); }
  bool at_end() { return scanner_.token_across_lines().empty(); }
  [[noreturn]] void fail(const std::string& message) const { throw_malformed_line(scanner_.line_number(), message); }

 private:
  void note_beginning(std::int64_t line) {
    if (begins_section_) section_line_ = line;
    (line != last_line_ ? begins_lines_ : follows_in_line_) = true;
    has_mixed_lines_ = has_mixed_lines_ || (begins_lines_ && follows_in_line_ && line != section_line_);
    begins_section_ = begins_element_ = false;
  }

  TextScanner scanner_;
  StopPace pace_;
  std::int64_t section_line_ = 0;  ///< line in which the current section begins
  std::int64_t last_line_ = 0;     ///< line of the latest number
  bool begins_section_ = false;
  bool begins_element_ = false;
  bool begins_lines_ = false;     ///< whether some element of the current section begins a line
  bool follows_in_line_ = false;  ///< whether some element of the current section begins within a line
  bool has_mixed_lines_ = false;  ///< whether both happened in a section of several lines
};

/// Reads the numbers of a binary body.
class BinaryBody {
 public:
  BinaryBody(const Header& header, std::size_t header_size, const CancellationToken& cancellation)
      : bytes_(header.body),
        header_size_(header_size),
        big_endian_(header.encoding == Encoding::big_endian),
        pace_(cancellation) {}

  double number(Scalar type) {
    const std::uint64_t bits = read_bits(size_of(type));
    switch (type) {
      case Scalar::int8:
        return static_cast<std::int8_t>(bits);
      case Scalar::int16:
        return static_cast<std::int16_t>(bits);
      case Scalar::int32:
        return static_cast<std::int32_t>(bits);
      case Scalar::float32:
        return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
      case Scalar::float64:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }
  void skip(const Element& element) {
    std::size_t size = 0;
    bool has_list = false;
    for (const Property& property : element.properties) {
      has_list = has_list || property.count_type;
      size += size_of(property.type);
    }
    if (!has_list) {
      if (size > 0) skip_values(static_cast<double>(element.count), size);
      return;
    }
    for (std::int64_t i = 0; i < element.count; ++i) {
      check_for_stop();
      for (const Property& property : element.properties) skip_property(property);
    }
  }
  void check_for_stop() { pace_.check(); }
  void skip_property(const Property& property) {
    skip_values(property.count_type ? number(*property.count_type) : 1, size_of(property.type));
  }
  void begin_element(std::int64_t) {}
  void check_rest() const {}
  bool at_end() const { return offset_ == bytes_.size(); }
  [[noreturn]] void fail(const std::string& message) const { throw_malformed_byte(header_size_ + offset_, message); }

 private:
  std::uint64_t read_bits(std::size_t size) {
    if (bytes_.size() - offset_ < size) fail("expected a number, found the end of the file");
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t from = big_endian_ ? offset_ + i : offset_ + size - 1 - i;
      bits = bits << 8 | static_cast<unsigned char>(bytes_[from]);
    }
    offset_ += size;
    return bits;
  }
  void skip_values(double count, std::size_t size) {
    const std::size_t remaining_bytes = bytes_.size() - offset_;
    const std::size_t capacity = remaining_bytes / size;
    if (!(count >= 0) || count > static_cast<double>(capacity)) {
      fail("expected more values than the " + std::to_string(remaining_bytes) + " bytes that are left can hold");
    }
    offset_ += static_cast<std::size_t>(count) * size;
  }

  std::string_view bytes_;
  std::size_t header_size_;
  std::size_t offset_ = 0;
  bool big_endian_;
  StopPace pace_;
};

template <typename Body>
void read_vertices(Body& body, const Element& element, SoupBuilder& builder) {
  const int axes[] = {element.find("x"), element.find("y"), element.find("z")};
  for (const int axis : axes) {
    if (axis < 0 || element.properties[axis].count_type) body.fail("the vertices have no properties x, y and z");
  }
  for (std::int64_t v = 0; v < element.count; ++v) {
    Eigen::Vector3d p;
    body.begin_element(v);
    for (int i = 0; i < static_cast<int>(element.properties.size()); ++i) {
      const Property& property = element.properties[i];
      if (i == axes[0] || i == axes[1] || i == axes[2]) {
        p[i == axes[0] ? 0 : i == axes[1] ? 1 : 2] = body.number(property.type);
      } else {
        body.skip_property(property);
      }
    }
    builder.add_vertex(p);
  }
}

/// Reads a number that must be an integer in [0, limit).
template <typename Body>
std::int64_t integer_below(Body& body, Scalar type, double limit, const char* what) {
  const double value = body.number(type);
  if (value >= 0 && value < limit && value == std::floor(value)) return static_cast<std::int64_t>(value);
  body.fail(std::string(what) + " is not an integer from 0 to " + std::to_string(static_cast<std::int64_t>(limit) - 1));
}

/// The index of the list of vertex numbers among the properties of an element.
template <typename Body>
int find_vertex_list(const Body& body, const Element& element) {
  int list = element.find("vertex_indices");
  if (list < 0) list = element.find("vertex_index");
  if (list < 0 || !element.properties[list].count_type)
    body.fail("the element " + in_quotes(element.name) + " has no list property vertex_indices");
  return list;
}

template <typename Body>
void read_faces(Body& body, const Element& element, std::int64_t vertices, SoupBuilder& builder) {
  const int list = find_vertex_list(body, element);
  std::vector<std::int32_t> corners;
  for (std::int64_t f = 0; f < element.count; ++f) {
    body.begin_element(f);
    for (int i = 0; i < static_cast<int>(element.properties.size()); ++i) {
      const Property& property = element.properties[i];
      if (i != list) {
        body.skip_property(property);
        continue;
      }
      corners.clear();
      const std::int64_t size = integer_below(body, *property.count_type, 0x1p31, "the number of corners");
      for (std::int64_t corner = 0; corner < size; ++corner) {
        body.check_for_stop();
        const std::int64_t v = integer_below(body, property.type, static_cast<double>(vertices), "a vertex number");
        corners.push_back(static_cast<std::int32_t>(v));
      }
      builder.add_polygon(corners);
    }
  }
}

/// Makes triangles from the vertices of a strip: each vertex forms one with the two before it. Every second triangle is
/// turned, so that all orientations agree.
class StripReader {
 public:
  explicit StripReader(SoupBuilder& builder) : builder_(builder) {}

  void restart() { length_ = 0; }
  void add(std::int32_t v) {
    // A strip repeats a vertex to turn around a corner. Triangles with a repeated vertex are no faces.
    const bool is_face = length_ >= 2 && first_ != second_ && second_ != v && v != first_;
    if (is_face) {
      const bool turned = length_ % 2 == 1;
      const std::int32_t corners[3] = {turned ? second_ : first_, turned ? first_ : second_, v};
      builder_.add_polygon(corners);
    }
    first_ = second_;
    second_ = v;
    ++length_;
  }

 private:
  SoupBuilder& builder_;
  std::int32_t first_ = -1, second_ = -1;
  std::int64_t length_ = 0;
};

/// Reads triangle strips: lists of vertex numbers in which -1 separates two strips.
template <typename Body>
void read_strips(Body& body, const Element& element, std::int64_t vertices, SoupBuilder& builder) {
  const int list = find_vertex_list(body, element);
  StripReader strip(builder);
  for (std::int64_t s = 0; s < element.count; ++s) {
    body.begin_element(s);
    strip.restart();
    for (int i = 0; i < static_cast<int>(element.properties.size()); ++i) {
      const Property& property = element.properties[i];
      if (i != list) {
        body.skip_property(property);
        continue;
      }
      const std::int64_t size = integer_below(body, *property.count_type, 0x1p31, "the number of vertices of a strip");
      for (std::int64_t k = 0; k < size; ++k) {
        body.check_for_stop();
        const double v = body.number(property.type);
        if (v == -1) {
          strip.restart();
        } else if (v >= 0 && v < static_cast<double>(vertices) && v == std::floor(v)) {
          strip.add(static_cast<std::int32_t>(v));
        } else {
          body.fail("a vertex number of a strip is not an integer from -1 to " + std::to_string(vertices - 1));
        }
      }
    }
  }
}

template <typename Body>
TriangleSoup read_body(Body body, const Header& header, const MeshLimits& limits, const Execution& execution) {
  SoupBuilder builder(limits, execution);
  const Element* vertices = nullptr;
  const Element* faces = nullptr;
  const Element* strips = nullptr;
  for (const Element& element : header.elements) {
    for (const auto& [name, found] :
         {std::pair{"vertex", &vertices}, std::pair{"face", &faces}, std::pair{"tristrips", &strips}}) {
      if (element.name != name) continue;
      if (*found) body.fail("the header has more than one element " + std::string(name));
      *found = &element;
    }
  }
  if (!vertices) body.fail("the header has no element vertex");
  if (!faces && !strips) body.fail("the header has no element face and no element tristrips");
  const std::int64_t face_count = faces ? faces->count : 0;
  builder.check_announced(vertices->count, face_count);
  builder.reserve(plausible_count(vertices->count, header.body.size(), 3),
                  plausible_count(face_count, header.body.size(), 4));
  std::int64_t skipped = 0;
  std::string_view first_skipped;
  for (const Element& element : header.elements) {
    if (&element == vertices) {
      read_vertices(body, element, builder);
    } else if (&element == faces) {
      read_faces(body, element, vertices->count, builder);
    } else if (&element == strips) {
      read_strips(body, element, vertices->count, builder);
    } else {
      body.skip(element);
      if (skipped++ == 0) first_skipped = element.name;
    }
  }
  if (skipped > 0) {
    builder.add_warning("Elements other than vertex and face were left out: " + in_quotes(first_skipped) +
                        (skipped > 1 ? " and " + std::to_string(skipped - 1) + " more." : "."));
  }
  if (!body.at_end()) {
    body.check_rest();
    builder.add_warning("What follows the last element was left out.");
  }
  return std::move(builder).finish();
}

}  // namespace

TriangleSoup read_ply(std::string_view bytes, const MeshLimits& limits, const Execution& execution) {
  const Header header = read_header(without_byte_order_mark(bytes));
  const CancellationToken& cancellation = execution.cancellation;
  if (header.encoding == Encoding::ascii) return read_body(TextBody(header, cancellation), header, limits, execution);
  return read_body(BinaryBody(header, bytes.size() - header.body.size(), cancellation), header, limits, execution);
}

}  // namespace supple::surface
