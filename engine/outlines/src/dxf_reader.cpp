#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "reading.h"

namespace supple::outlines {
namespace {

constexpr int max_degree = 25;
/// Limit of the x and y components of an entity's unit normal; entities that are tilted by more are left out.
constexpr double max_tilt = 1e-6;
/// One degree in radians.
constexpr double degree = std::numbers::pi / 180;

// This reader does not use Debian's library for DXF (dxflib 3.26), which trusts the counts in a file, so that its heap
// overflows, and which does not terminate on lines beyond 1024 bytes.

/// A group: its code, and its value without blanks around it.
struct Group {
  int code = 0;
  std::string_view value;
  std::size_t line = 0;  ///< line of the value
};

/// Reads pairs of lines, a code and a value. Comments are skipped.
class GroupReader {
 public:
  explicit GroupReader(std::string_view text) : rest_(text) {}

  std::size_t bytes_left() const { return rest_.size(); }

  /// The next group; none at the end of the text.
  std::optional<Group> next() {
    while (true) {
      const auto first = line();
      if (!first) return std::nullopt;
      int code = 0;
      const auto [end, error] = std::from_chars(first->data(), first->data() + first->size(), code);
      if (error != std::errc() || end != first->data() + first->size()) {
        if (first->empty() && without_leading_spaces(rest_).empty()) return std::nullopt;
        refuse("line " + std::to_string(line_) + ": " + in_quotes(*first) + " is no group code of a DXF file");
      }
      const auto value = line();
      if (!value) refuse("line " + std::to_string(line_) + ": the file ends after a group code");
      if (code != 999) return Group{code, *value, line_};
    }
  }

 private:
  std::optional<std::string_view> line() {
    if (rest_.empty()) return std::nullopt;
    const auto end = rest_.find('\n');
    std::string_view found = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++line_;
    found = without_leading_spaces(found);
    while (!found.empty() && is_space(found.back())) found.remove_suffix(1);
    return found;
  }

  std::string_view rest_;
  std::size_t line_ = 0;
};

double number_of(const Group& group) {
  std::string_view text = group.value;
  const auto value = take_number(text);
  if (!value || !text.empty())
    refuse("line " + std::to_string(group.line) + ": " + in_quotes(group.value) + " is no number");
  return *value;
}

/// An entity, or a row of a table: its kind and its groups.
struct Entity {
  std::string_view kind;
  std::size_t line = 0;
  std::vector<Group> groups;

  std::optional<Group> find(int code) const {
    for (const Group& group : groups) {
      if (group.code == code) return group;
    }
    return std::nullopt;
  }
  double number(int code, double default_value) const {
    const auto group = find(code);
    return group ? number_of(*group) : default_value;
  }
  double number(int code) const {
    const auto group = find(code);
    if (!group) refuse(description() + " has no group " + std::to_string(code));
    return number_of(*group);
  }
  int integer(int code, int default_value) const {
    const double value = number(code, default_value);
    return std::abs(value) < 1e9 ? static_cast<int>(value) : default_value;
  }
  bool flag(int code, int bit) const { return (integer(code, 0) & bit) != 0; }
  /// The position of a block or an insert, whose coordinates are 0 where they are missing.
  Point position() const { return {number(10, 0), number(20, 0)}; }
  Point point(int code) const { return {number(code), number(code + 10)}; }
  std::string_view text(int code) const {
    const auto group = find(code);
    return group ? group->value : std::string_view();
  }
  std::string description() const { return "the " + std::string(kind) + " of line " + std::to_string(line); }
};

struct DxfUnit {
  int code;
  double millimetres;
};
/// Values of $INSUNITS. Other units, which are not used for parts, are ignored.
constexpr std::array<DxfUnit, 11> units{{{1, 25.4},
                                         {2, 304.8},
                                         {4, 1},
                                         {5, 10},
                                         {6, 1000},
                                         {8, 25.4e-6},
                                         {9, 25.4e-3},
                                         {10, 914.4},
                                         {13, 1e-3},
                                         {14, 100},
                                         {15, 1e4}}};

/// A vertex of a polyline, and the bulge of the side that begins there.
struct Vertex {
  Point position = Point::Zero();
  double bulge = 0;
};

/// A block. Its groups are read again wherever it is inserted; `base` is the point of it that comes to the insert's
/// position.
struct Block {
  GroupReader groups;
  std::optional<Group> first;
  Point base = Point::Zero();
};

/// The properties that an insert gives to all entities of its block.
struct InsertProperties {
  Map map = Map::Identity();
  std::string layer;
  std::vector<std::string> names;
  std::string group;  ///< different for each insert
  int depth = 0;      ///< 0 outside blocks
};

/// A name with its escapes, such as \\U+00E9, replaced by characters of UTF-8.
std::string decoded(std::string_view name) {
  std::string result;
  while (!name.empty()) {
    unsigned code = 0;
    const char* digits = name.data() + 3;
    if (name.size() >= 7 && name.starts_with("\\U+") &&
        std::from_chars(digits, digits + 4, code, 16).ptr == digits + 4 && code >= 0x80 &&
        !(code >= 0xD800 && code < 0xE000)) {
      if (code < 0x800) {
        result += static_cast<char>(0xC0U | (code >> 6U));
      } else {
        result += static_cast<char>(0xE0U | (code >> 12U));
        result += static_cast<char>(0x80U | ((code >> 6U) & 0x3FU));
      }
      result += static_cast<char>(0x80U | (code & 0x3FU));
      name.remove_prefix(7);
    } else {
      result += name.front();
      name.remove_prefix(1);
    }
  }
  return result;
}

class DxfReader {
 public:
  DxfReader(std::string_view text, const DrawingOptions& options, const Execution& execution)
      : groups_(text), options_(options), execution_(execution) {}

  RawDrawing read() {
    advance();
    while (group_) {
      if (group_->code == 0 && group_->value == "EOF") break;
      if (group_->code == 0 && group_->value == "SECTION") {
        advance();
        if (!group_ || group_->code != 2) refuse("a section of the file has no name");
        read_section(group_->value);
      } else {
        advance();
      }
    }
    if (!has_entities_) refuse("it has no section ENTITIES");
    const double unit = millimetres_of(options_.unit).value_or(unit_);
    drawing_.unit = unit;
    drawing_.unit_is_known = unit_is_known_ || options_.unit != LengthUnit::automatic;
    if (!drawing_.unit_is_known && !options_.width && is_imperial_)
      drawing_.warnings.emplace_back(
          "The drawing was made with English measures ($MEASUREMENT): its unit may be the inch.");
    if (unit != 1) {
      const Map scale(Eigen::Scaling(unit));
      for (Curve& curve : drawing_.curves) transform(curve, scale);
    }
    return std::move(drawing_);
  }

 private:
  void advance() {
    if (++groups_read_ % groups_between_checks == 0) execution_.cancellation.throw_if_requested();
    const std::size_t before = groups_.bytes_left();
    group_ = groups_.next();
    if (insert_.depth > 0) count_copied(before - groups_.bytes_left());
  }
  /// Counts a group of a block, or an insert, whose block may be empty. Throws "outline.too_large".
  void count_copied(std::size_t bytes) {
    copied_groups_ += 1 + bytes / bytes_per_copied_group;
    if (copied_groups_ <= max_copied_groups) return;
    const std::string limit = std::to_string(max_copied_groups);
    throw Error("outline.too_large", "The drawing inserts blocks of more than " + limit + " groups in all.",
                {{"text", "inserts blocks of more than " + limit + " groups in all"}});
  }
  bool at_end_of_section() const { return !group_ || (group_->code == 0 && group_->value == "ENDSEC"); }

  void read_section(std::string_view name) {
    const bool header = name == "HEADER", tables = name == "TABLES", entities = name == "ENTITIES";
    const bool blocks = name == "BLOCKS";
    has_entities_ = has_entities_ || entities;
    advance();
    while (!at_end_of_section()) {
      if (header && group_->code == 9 && group_->value == "$INSUNITS") {
        advance();
        if (group_) read_unit(*group_);
      } else if (header && group_->code == 9 && group_->value == "$MEASUREMENT") {
        advance();
        is_imperial_ = group_ && group_->code == 70 && group_->value == "0";
      } else if (group_->code == 0 && (entities || (tables && group_->value == "LAYER"))) {
        const Entity entity = take_entity();
        entities ? read_entity(entity) : read_layer(entity);
        continue;
      }
      if (blocks && group_->code == 0 && group_->value == "BLOCK") {
        const Entity block = take_entity();
        // The entities of the block are read where it is inserted.
        blocks_.try_emplace(std::string(block.text(2)), Block{groups_, group_, block.position()});
        continue;
      }
      advance();
    }
  }

  Entity take_entity() {
    Entity entity{group_->value, group_->line, {}};
    advance();
    while (group_ && group_->code != 0) {
      entity.groups.push_back(*group_);
      advance();
    }
    return entity;
  }

  void read_unit(const Group& group) {
    const double code = number_of(group);
    const auto* const found =
        std::find_if(units.begin(), units.end(), [code](const DxfUnit& unit) { return unit.code == code; });
    if (found == units.end()) return;
    unit_ = found->millimetres;
    unit_is_known_ = true;
  }

  void read_layer(const Entity& layer) {
    if (layer.flag(70, 1) || layer.integer(62, 0) < 0) hidden_layers_.emplace(layer.text(2));
  }

  /// The entity's layer. Entities of a block on layer 0 are on the layer of its insert.
  std::string layer_of(const Entity& entity) const {
    const std::string_view own = entity.text(8);
    return !insert_.layer.empty() && (own.empty() || own == "0") ? insert_.layer : std::string(own);
  }

  std::string describe(const Entity& entity) const {
    return entity.description() + " (layer " + in_quotes(layer_of(entity)) + ")";
  }

  /// Whether the entity is shown in model space.
  bool is_shown(const Entity& entity) {
    if (entity.integer(67, 0) == 1) {
      leave_out(drawing_, std::string(entity.kind) + " of paper space", describe(entity),
                "it lies on a sheet (paper space); only the model is read");
      return false;
    }
    const std::string layer = layer_of(entity);
    if (entity.integer(60, 0) == 1) {
      leave_hidden(drawing_, describe(entity), "it is invisible");
    } else if (hidden_layers_.contains(layer)) {
      leave_hidden(drawing_, describe(entity), "its layer is off or frozen");
    } else if (layer == "Defpoints" || layer == "DEFPOINTS") {
      leave_hidden(drawing_, describe(entity), "its layer is that of helping points, which is never plotted");
    } else {
      return true;
    }
    return false;
  }

  void read_entity(const Entity& entity) {
    if (entity.kind == "POLYLINE") return read_polyline(entity);
    if (entity.kind == "VERTEX" || entity.kind == "SEQEND" || !is_shown(entity)) return;
    if (entity.kind == "LWPOLYLINE") {
      std::vector<Vertex> vertices;
      for (const Group& group : entity.groups) {
        if (group.code == 10) vertices.emplace_back().position.x() = number_of(group);
        if (vertices.empty()) continue;
        if (group.code == 20) vertices.back().position.y() = number_of(group);
        if (group.code == 42) vertices.back().bulge = number_of(group);
      }
      return add_polyline(entity, vertices);
    }
    if (entity.kind == "LINE") return add_line(entity);
    if (entity.kind == "CIRCLE" || entity.kind == "ARC") return add_circle(entity);
    if (entity.kind == "ELLIPSE") return add_ellipse(entity);
    if (entity.kind == "SPLINE") return add_spline(entity);
    if (entity.kind == "INSERT") return insert(entity);
    // Annotations and marks are no shapes, and are left out without a message.
    constexpr std::array<std::string_view, 12> annotations{"TEXT",    "MTEXT",  "DIMENSION",   "LEADER",
                                                           "MLEADER", "ATTDEF", "VIEWPORT",    "POINT",
                                                           "XLINE",   "RAY",    "MULTILEADER", "TOLERANCE"};
    const bool annotates = std::find(annotations.begin(), annotations.end(), entity.kind) != annotations.end();
    if (!annotates) leave_out(drawing_, shortened(entity.kind), describe(entity));
  }

  /// The vertices of a POLYLINE are entities of their own, up to a SEQEND.
  void read_polyline(const Entity& entity) {
    constexpr int mesh = 16 | 64;
    constexpr int control_point = 16;
    std::vector<Vertex> vertices;
    while (group_ && group_->code == 0 && group_->value == "VERTEX") {
      const Entity vertex = take_entity();
      if (!vertex.flag(70, control_point)) vertices.push_back({vertex.point(10), vertex.number(42, 0)});
    }
    if (!is_shown(entity)) return;
    if (entity.flag(70, mesh)) {
      leave_out(drawing_, "POLYLINE mesh", describe(entity));
      return;
    }
    add_polyline(entity, vertices);
  }

  /// Draws a block at one position, or in rows and columns.
  void insert(const Entity& entity) {
    const std::string name(entity.text(2));
    const auto found = blocks_.find(name);
    const double orientation = orientation_of(entity);
    if (found == blocks_.end() || orientation == 0)
      return leave_out(drawing_, orientation == 0 ? "tilted INSERT" : "INSERT of no block of the file",
                       describe(entity));
    check_nesting(insert_.depth + 1, "blocks", entity.description());
    const int columns = std::max(1, entity.integer(70, 1)), rows = std::max(1, entity.integer(71, 1));
    const Point step(entity.number(44, 0), entity.number(45, 0));
    const Map turned = insert_.map * Eigen::Scaling(orientation, 1.0) * Eigen::Translation2d(entity.position()) *
                       Eigen::Rotation2Dd(entity.number(50, 0) * degree);
    const Map scaled =
        Eigen::Scaling(entity.number(41, 1), entity.number(42, 1)) * Map(Eigen::Translation2d(-found->second.base));
    InsertProperties inner{turned, layer_of(entity), insert_.names, {}, insert_.depth + 1};
    inner.names.insert(inner.names.begin(), shortened(decoded(name)));
    inner.names.resize(std::min(inner.names.size(), max_names - 1));
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        inner.map = turned * Eigen::Translation2d(column * step.x(), row * step.y()) * scaled;
        inner.group = "/" + std::to_string(++inserts_);
        read_block(found->second, inner);
      }
    }
  }

  void read_block(const Block& block, const InsertProperties& inner) {
    if (++groups_read_ % groups_between_checks == 0) execution_.cancellation.throw_if_requested();
    count_copied(0);
    const auto outer = std::tuple(groups_, group_, insert_);
    groups_ = block.groups;
    group_ = block.first;
    insert_ = inner;
    while (!at_end_of_section() && !(group_->code == 0 && group_->value == "ENDBLK"))
      group_->code == 0 ? read_entity(take_entity()) : advance();
    std::tie(groups_, group_, insert_) = outer;
  }

  /// The direction of the entity's normal: 1 up, -1 down, so that its own coordinates are mirrored, 0 if it is tilted.
  static double orientation_of(const Entity& entity) {
    const bool is_horizontal =
        std::abs(entity.number(210, 0)) <= max_tilt && std::abs(entity.number(220, 0)) <= max_tilt;
    return !is_horizontal ? 0 : entity.number(230, 1) < 0 ? -1 : 1;
  }

  /// Adds a curve that is given in the entity's own coordinates or, if `is_world`, in those of the drawing.
  void add(const Entity& entity, Curve curve, bool is_world) {
    const double orientation = orientation_of(entity);
    if (orientation == 0) {
      leave_out(drawing_, "tilted " + shortened(entity.kind), describe(entity),
                "its plane is tilted against that of the drawing");
      return;
    }
    if (orientation < 0 && !is_world) transform(curve, Map(Eigen::Scaling(-1.0, 1.0)));
    transform(curve, insert_.map);
    const std::string layer = shortened(decoded(layer_of(entity)));
    curve.group = layer + insert_.group;
    if (!layer.empty()) curve.names = {layer};
    curve.names.insert(curve.names.end(), insert_.names.begin(), insert_.names.end());
    curve.description = describe(entity);
    add_curve(drawing_, std::move(curve), execution_);
  }

  void add_polyline(const Entity& entity, const std::vector<Vertex>& vertices) {
    if (vertices.size() < 2) return;
    check_pieces(vertices.size());
    Curve curve;
    curve.closed = entity.flag(70, 1);
    curve.begin = vertices[0].position;
    const std::size_t sides = vertices.size() - (curve.closed ? 0 : 1);
    for (std::size_t k = 0; k < sides; ++k) {
      const Vertex& from = vertices[k];
      curve.pieces.push_back(bulge(from.position, vertices[(k + 1) % vertices.size()].position, from.bulge));
    }
    add(entity, std::move(curve), false);
  }

  void add_line(const Entity& entity) {
    Curve curve;
    curve.begin = entity.point(10);
    curve.pieces.emplace_back(Line{entity.point(11)});
    add(entity, std::move(curve), true);
  }

  void add_circle(const Entity& entity) {
    const double radius = entity.number(40);
    if (!(radius > 0)) refuse(entity.description() + ": its radius must be positive");
    const bool whole = entity.kind == "CIRCLE";
    const double from = whole ? 0 : entity.number(50) * degree, to = whole ? 0 : entity.number(51) * degree;
    add_arc(entity, entity.point(10), {radius, 0}, {0, radius}, from, to, false);
  }

  void add_ellipse(const Entity& entity) {
    const Point major = entity.point(11);
    const double ratio = entity.number(40), orientation = orientation_of(entity);
    if (!(ratio > 0) || major.isZero(0)) refuse(entity.description() + ": its axes must be positive");
    const Point minor = ratio * (orientation < 0 ? Point(major.y(), -major.x()) : Point(-major.y(), major.x()));
    add_arc(entity, entity.point(10), major, minor, entity.number(41, 0), entity.number(42, 2 * std::numbers::pi),
            true);
  }

  /// Adds the arc centre + cosine cos t + sine sin t for t from `from` counterclockwise to `to`, radians. Equal
  /// directions give the whole ellipse.
  void add_arc(const Entity& entity, const Point& centre, const Point& cosine, const Point& sine, double from,
               double to, bool is_world) {
    constexpr double turn = 2 * std::numbers::pi, tolerance = 1e-9;
    double sweep = std::fmod(to - from, turn);
    if (sweep < 0) sweep += turn;
    const auto at = [&](double t) { return Point(centre + cosine * std::cos(t) + sine * std::sin(t)); };
    Curve curve;
    curve.begin = at(from);
    curve.closed = sweep < tolerance || turn - sweep < tolerance;
    const Point end = curve.closed ? curve.begin : at(from + sweep);
    curve.pieces.emplace_back(Arc{centre, cosine, sine, from, curve.closed ? turn : sweep, end});
    add(entity, std::move(curve), is_world);
  }

  void add_spline(const Entity& entity) {
    Spline spline;
    spline.degree = entity.integer(71, 3);
    for (const Group& group : entity.groups) {
      if (group.code == 40) spline.knots.push_back(number_of(group));
      if (group.code == 41) spline.weights.push_back(number_of(group));
      if (group.code == 10) spline.control_points.emplace_back(number_of(group), 0);
      if (group.code == 20 && !spline.control_points.empty()) spline.control_points.back().y() = number_of(group);
    }
    const std::size_t n = spline.control_points.size();
    check_pieces(n);
    if (n == 0) {
      leave_out(drawing_, "SPLINE without control points", describe(entity),
                "it is given by points to go through only; make it a polyline or a spline of control points");
      return;
    }
    const bool degree_fits =
        spline.degree >= 1 && spline.degree <= max_degree && n > static_cast<std::size_t>(spline.degree);
    if (!degree_fits || spline.knots.size() != n + static_cast<std::size_t>(spline.degree) + 1 ||
        !std::is_sorted(spline.knots.begin(), spline.knots.end()) ||
        !(spline.knots[static_cast<std::size_t>(spline.degree)] < spline.knots[n])) {
      refuse(entity.description() +
             ": a spline of degree d has d + 1 or more control points, and as many knots and d + 1 more, in increasing "
             "order");
    }
    const bool weights_fit = spline.weights.empty() || spline.weights.size() == n;
    if (!weights_fit || std::any_of(spline.weights.begin(), spline.weights.end(), [](double w) { return !(w > 0); }))
      refuse(entity.description() + ": a spline has as many weights as control points or none, and they are positive");
    Curve curve;
    curve.begin = point_of(spline, spline.knots[static_cast<std::size_t>(spline.degree)]);
    curve.closed = entity.flag(70, 1);
    curve.pieces.emplace_back(std::move(spline));
    add(entity, std::move(curve), true);
  }

  static constexpr std::size_t groups_between_checks = 16'384;
  /// Limit of the groups that inserts read, since the number of entities grows exponentially with nested blocks.
  static constexpr std::size_t max_copied_groups = 2'000'000;
  /// This many bytes count as one more group.
  static constexpr std::size_t bytes_per_copied_group = 64;

  GroupReader groups_;
  const DrawingOptions& options_;
  const Execution& execution_;
  RawDrawing drawing_;
  std::optional<Group> group_;
  std::set<std::string> hidden_layers_;
  std::map<std::string, Block> blocks_;
  InsertProperties insert_;  ///< the insert whose block is being read
  std::size_t inserts_ = 0;
  std::size_t copied_groups_ = 0;
  std::size_t groups_read_ = 0;
  double unit_ = 1;
  bool unit_is_known_ = false;
  bool is_imperial_ = false;  ///< from $MEASUREMENT; used for a warning if the file gives no unit
  bool has_entities_ = false;
};

}  // namespace

RawDrawing read_dxf(std::string_view text, const DrawingOptions& options, const Execution& execution) {
  return DxfReader(text, options, execution).read();
}

}  // namespace supple::outlines
