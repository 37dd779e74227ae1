#include "supple/tiling/definition_text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <utility>

#include "definition_fields.h"
#include "supple/base/error.h"
#include "supple/tiling/isohedral_types.h"

namespace supple::tiling {
namespace {

constexpr std::string_view first_line = "family definition 1";
constexpr std::array<std::pair<EdgeSymmetry, std::string_view>, 4> class_letters{{{EdgeSymmetry::any, "J"},
                                                                                  {EdgeSymmetry::point_symmetric, "S"},
                                                                                  {EdgeSymmetry::mirror_symmetric, "U"},
                                                                                  {EdgeSymmetry::straight, "I"}}};

/// Words of one line, separated by blanks.
class LineWriter {
 public:
  LineWriter(std::string& text, std::string_view word) : text_(text) { text_ += word; }
  ~LineWriter() { text_ += '\n'; }
  LineWriter(const LineWriter&) = delete;
  LineWriter& operator=(const LineWriter&) = delete;

  LineWriter& word(std::string_view word) {
    text_ += ' ';
    text_ += word;
    return *this;
  }

  template <class T>
  requires std::integral<T> || std::floating_point<T> LineWriter& number(T value) {
    std::array<char, 32> buffer;
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
    return word({buffer.data(), static_cast<std::size_t>(end - buffer.data())});
  }

  LineWriter& expression(const AffineExpression& expression) {
    number(expression.slopes.size()).number(expression.constant);
    for (const double slope : expression.slopes) number(slope);
    return *this;
  }

  LineWriter& point(const ExpressionPoint& point) { return expression(point.x).expression(point.y); }

  /// A text that may have line breaks, up to the end of the line.
  void rest(std::string_view text) {
    text_ += ' ';
    for (const char c : text) {
      if (c == '\n')
        text_ += "\\n";
      else if (c == '\\')
        text_ += "\\\\";
      else
        text_ += c;
    }
  }

 private:
  std::string& text_;
};

void write_tile(std::string& text, const TileDefinition& tile) {
  for (const auto& vertex : tile.vertices) LineWriter(text, "vertex").point(vertex);
  for (const auto& edge : tile.edges)
    LineWriter(text, "edge").number(edge.shape).number(int{edge.turned}).number(int{edge.mirrored});
  for (const auto& translation : tile.translations) LineWriter(text, "translation").point(translation);
  for (const auto& placement : tile.placements) {
    LineWriter line(text, "placement");
    for (const double entry : placement.linear) line.number(entry);
    line.point(placement.offset);
  }
}

void write_shape(std::string& text, const EdgeShape& shape) {
  LineWriter line(text, "shape");
  for (const auto& [symmetry, letter] : class_letters)
    if (symmetry == shape.symmetry) line.word(letter);
  if (const auto* polyline = std::get_if<PolylineEdge>(&shape.line)) {
    line.word("points").number(polyline->points.size());
    for (const auto& point : polyline->points) line.point(point);
  } else if (const auto* curve = std::get_if<SineEdge>(&shape.line)) {
    line.word("sines").number(curve->pieces).number(curve->sines.size());
    for (const auto& sine : curve->sines) line.expression(sine);
  } else {
    line.word("straight");
  }
}

/// Takes a text apart. Each function throws "file.unreadable" where the text has something else.
class TextReader {
 public:
  explicit TextReader(std::string_view text) : text_(text) {}

  FamilyDefinition read() {
    if (!next_line() || line_ != first_line) fail("a definition begins with \"" + std::string(first_line) + '"');
    while (next_line()) read_line();
    if (const auto* type = find_isohedral_type(definition_.isohedral_type)) {
      if (!definition_.tile.vertices.empty()) fail("a definition has a tile or the number of a type");
      definition_.tile = type->tile;
    } else if (translations_ != definition_.tile.translations.size()) {
      fail("two translations are missing");
    }
    if (const auto faults = field_faults(definition_); !faults.empty())
      fail(faults.front().where + " " + faults.front().message);
    return std::move(definition_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw Error("file.unreadable",
                "The definition of a family cannot be read: line " + std::to_string(number_) + ": " + why + ".");
  }

  bool next_line() {
    if (text_.empty()) return false;
    ++number_;
    const auto end = text_.find('\n');
    if (end == std::string_view::npos) fail("the last line is cut off");
    line_ = text_.substr(0, end);
    text_.remove_prefix(end + 1);
    return true;
  }

  std::string_view word() {
    const auto end = line_.find(' ');
    const auto result = line_.substr(0, end);
    line_ = end == std::string_view::npos ? std::string_view() : line_.substr(end + 1);
    return result;
  }

  template <class T>
  T number() {
    const auto text = word();
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) fail("a number is missing or damaged");
    if constexpr (std::floating_point<T>)
      if (!std::isfinite(value)) fail("a number is not finite");
    return value;
  }

  std::size_t count(std::size_t max) {
    const auto result = number<std::size_t>();
    if (result > max) fail("has more than " + std::to_string(max) + " entries");
    return result;
  }

  AffineExpression expression() {
    const auto slopes = count(max_defined_parameters);
    AffineExpression result = number<double>();
    for (std::size_t k = 0; k < slopes; ++k) result.slopes.push_back(number<double>());
    return result;
  }

  ExpressionPoint point() {
    auto x = expression();
    return {std::move(x), expression()};
  }

  std::string rest() {
    std::string result;
    for (std::size_t k = 0; k < line_.size(); ++k) {
      const bool is_escaped = line_[k] == '\\' && k + 1 < line_.size();
      if (is_escaped) ++k;
      result += is_escaped && line_[k] == 'n' ? '\n' : line_[k];
    }
    line_ = {};
    return result;
  }

  EdgeShape shape() {
    EdgeShape result;
    const auto letter = word();
    bool is_known = false;
    for (const auto& [symmetry, known] : class_letters) {
      if (known != letter) continue;
      result.symmetry = symmetry;
      is_known = true;
    }
    if (!is_known) fail("a shape has the class J, S, U or I");
    const auto kind = word();
    if (kind == "points") {
      auto& polyline = result.line.emplace<PolylineEdge>();
      const auto points = count(max_polyline_points);
      for (std::size_t k = 0; k < points; ++k) polyline.points.push_back(point());
    } else if (kind == "sines") {
      auto& curve = result.line.emplace<SineEdge>();
      curve.pieces = number<int>();
      const auto sines = count(max_sines);
      for (std::size_t k = 0; k < sines; ++k) curve.sines.push_back(expression());
    } else if (kind != "straight") {
      fail("a shape is straight, or has points or sines");
    }
    return result;
  }

  DefinedParameter parameter() {
    DefinedParameter result;
    result.range.lower = number<double>();
    result.range.upper = number<double>();
    result.range.preset = number<double>();
    result.description = rest();
    return result;
  }

  DefinedPlacement placement() {
    DefinedPlacement result;
    for (double& entry : result.linear) entry = number<double>();
    result.offset = point();
    return result;
  }

  void add_translation() {
    if (translations_ == definition_.tile.translations.size()) fail("there are two translations");
    definition_.tile.translations[translations_++] = point();
  }

  void read_line() {
    auto& tile = definition_.tile;
    const auto name = word();
    if (name == "id")
      definition_.id = rest();
    else if (name == "description")
      definition_.description = rest();
    else if (name == "parameter")
      definition_.parameters.push_back(parameter());
    else if (name == "beam_width")
      definition_.beam_width = expression();
    else if (name == "mesh_size")
      definition_.sufficient_mesh_size = number<double>();
    else if (name == "isohedral_type")
      definition_.isohedral_type = number<int>();
    else if (name == "vertex")
      tile.vertices.push_back(point());
    else if (name == "edge")
      tile.edges.push_back({number<int>(), number<int>() != 0, number<int>() != 0});
    else if (name == "translation")
      add_translation();
    else if (name == "placement")
      tile.placements.push_back(placement());
    else if (name == "shape")
      definition_.shapes.push_back(shape());
    else
      fail("the word \"" + std::string(name.substr(0, 40)) + "\" is unknown");
    if (!line_.empty()) fail("has more than it should");
  }

  std::string_view text_;
  std::string_view line_;
  int number_ = 0;
  std::size_t translations_ = 0;
  FamilyDefinition definition_;
};

}  // namespace

std::string to_text(const FamilyDefinition& definition) {
  std::string text(first_line);
  text += '\n';
  LineWriter(text, "id").rest(definition.id);
  LineWriter(text, "description").rest(definition.description);
  for (const auto& [description, range] : definition.parameters)
    LineWriter(text, "parameter").number(range.lower).number(range.upper).number(range.preset).rest(description);
  LineWriter(text, "beam_width").expression(definition.beam_width);
  LineWriter(text, "mesh_size").number(definition.sufficient_mesh_size);
  if (definition.isohedral_type != 0)
    LineWriter(text, "isohedral_type").number(definition.isohedral_type);
  else
    write_tile(text, definition.tile);
  for (const auto& shape : definition.shapes) write_shape(text, shape);
  return text;
}

FamilyDefinition definition_of_text(std::string_view text) { return TextReader(text).read(); }

std::shared_ptr<const Family> family_of(const std::string& id, std::string_view definition_text) {
  if (definition_text.empty()) return {std::shared_ptr<void>(), &family(id)};
  auto definition = definition_of_text(definition_text);
  if (definition.id != id)
    throw Error("file.unreadable",
                "A file is of the family " + id + ", but has the definition of the family " + definition.id + ".");
  return std::make_shared<const Family>(make_family(std::move(definition)));
}

}  // namespace supple::tiling
