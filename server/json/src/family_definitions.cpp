#include "supple/json/family_definitions.h"

#include <algorithm>

#include "family_fields.h"
#include "request_parts.h"
#include "supple/tiling/isohedral_types.h"

namespace supple::json {
namespace {

using tiling::AffineExpression;
using tiling::EdgeSymmetry;
using tiling::ExpressionPoint;
using tiling::FamilyDefinition;

// The ranges of api/openapi.yaml.
constexpr double max_coefficient = 1e6;
constexpr double max_sufficient_mesh_size = 2;
constexpr double min_sufficient_mesh_size = 0.01;
constexpr std::size_t max_description_bytes = 500;
constexpr std::size_t max_shapes = tiling::max_tile_vertices;

constexpr auto class_names = names_of<EdgeSymmetry>({{EdgeSymmetry::any, "J"},
                                                     {EdgeSymmetry::point_symmetric, "S"},
                                                     {EdgeSymmetry::mirror_symmetric, "U"},
                                                     {EdgeSymmetry::straight, "I"}});

/// Reads the parts of a definition, whose expressions have factors for the parameters that it has read before.
class DefinitionReader {
 public:
  explicit DefinitionReader(Fields& fields) : fields_(fields), faults_(fields.faults()) {}

  FamilyDefinition read() {
    read_family_id(fields_, "id", definition_.id);
    read_text(fields_, "description", definition_.description);
    read_parameters();
    if (const auto* width = fields_.required("beam_width"))
      definition_.beam_width = expression(*width, fields_.at("beam_width"));
    fields_.number("mesh_size", definition_.sufficient_mesh_size, min_sufficient_mesh_size, max_sufficient_mesh_size);
    read_shapes();
    read_tile_or_type();
    return std::move(definition_);
  }

 private:
  void read_text(Fields& fields, std::string_view name, std::string& out) {
    const auto* value = fields.required(name);
    if (!value) return;
    if (!value->is_string() || value->get_ref<const std::string&>().size() > max_description_bytes) {
      return faults_.add(fields.at(name),
                         "must be a string of at most " + std::to_string(max_description_bytes) + " bytes");
    }
    out = value->get<std::string>();
  }

  /// Calls read(entry, pointer) for each entry of an array of bounded length.
  template <class Read>
  void each(Fields& fields, std::string_view name, bool is_required, std::size_t min, std::size_t max, Read read) {
    const auto* entries = fields.array(name, is_required, min, max, "");
    if (!entries) return;
    for (std::size_t k = 0; k < entries->size(); ++k) read((*entries)[k], fields.at(name) + "/" + std::to_string(k));
  }

  void read_parameters() {
    each(fields_, "parameters", true, 0, tiling::max_defined_parameters, [&](const auto& entry, const auto& pointer) {
      auto& parameter = definition_.parameters.emplace_back();
      Fields fields(entry, pointer, faults_);
      read_text(fields, "description", parameter.description);
      auto& [lower, upper, preset] = parameter.range;
      for (const auto& [name, out] :
           {std::pair<std::string_view, double*>{"lower", &lower}, {"upper", &upper}, {"default", &preset}}) {
        if (fields.required(name)) fields.number(name, *out, -max_coefficient, max_coefficient);
      }
      fields.finish();
    });
  }

  /// An expression is a number, or an array of the constant and the factors of parameters.
  AffineExpression expression(const Document& value, const std::string& pointer) {
    AffineExpression result;
    const auto number = [&](const Document& entry, const std::string& at) {
      double out = 0;
      read_number(entry, at, faults_, out, -max_coefficient, max_coefficient);
      return out;
    };
    if (!value.is_array()) {
      result.constant = number(value, pointer);
      return result;
    }
    const std::size_t max = 1 + definition_.parameters.size();
    if (value.empty() || value.size() > max) {
      faults_.add(pointer, "must be a number, or an array of a constant and factors of the " + std::to_string(max - 1) +
                               " parameters, but has " + std::to_string(value.size()) + " entries");
      return result;
    }
    result.constant = number(value[0], pointer + "/0");
    for (std::size_t k = 1; k < value.size(); ++k)
      result.slopes.push_back(number(value[k], pointer + "/" + std::to_string(k)));
    return result;
  }

  ExpressionPoint point(const Document& value, const std::string& pointer) {
    if (!value.is_array() || value.size() != 2) {
      faults_.add(pointer, "must be an array of two coordinates");
      return {};
    }
    AffineExpression x = expression(value[0], pointer + "/0");
    return {std::move(x), expression(value[1], pointer + "/1")};
  }

  void read_shapes() {
    each(fields_, "shapes", false, 0, max_shapes, [&](const auto& entry, const auto& pointer) {
      auto& shape = definition_.shapes.emplace_back();
      Fields fields(entry, pointer, faults_);
      fields.required("class");
      fields.choice("class", shape.symmetry, class_names);
      if (fields.present("points") && (fields.present("sines") || fields.present("pieces")))
        faults_.add(pointer, "must have \"points\", or \"sines\" and \"pieces\", or neither");
      if (fields.present("points")) {
        auto& line = shape.line.template emplace<tiling::PolylineEdge>();
        each(fields, "points", true, 1, tiling::max_polyline_points,
             [&](const auto& vertex, const auto& at) { line.points.push_back(point(vertex, at)); });
      }
      if (fields.present("sines") || fields.present("pieces")) {
        auto& curve = shape.line.template emplace<tiling::SineEdge>();
        each(fields, "sines", true, 1, tiling::max_sines,
             [&](const auto& sine, const auto& at) { curve.sines.push_back(expression(sine, at)); });
        fields.integer("pieces", curve.pieces, tiling::min_sine_pieces, tiling::max_sine_pieces);
      }
      fields.finish();
    });
  }

  void read_tile_or_type() {
    if (fields_.present("tile") == fields_.present("isohedral_type"))
      faults_.add(fields_.at("tile"), "either \"tile\" or \"isohedral_type\" is required");
    fields_.integer("isohedral_type", definition_.isohedral_type, 1, 93);
    if (definition_.isohedral_type != 0) {
      const auto* type = tiling::find_isohedral_type(definition_.isohedral_type);
      if (!type) return faults_.add(fields_.at("isohedral_type"), "must be the number of one of the 81 types");
      definition_.tile = type->tile;
      if (definition_.shapes.empty())
        for (const auto symmetry : type->symmetries) definition_.shapes.push_back({symmetry, tiling::StraightEdge{}});
    }
    nested(fields_, "tile", [&](Fields& tile) { read_tile(tile); });
  }

  void read_tile(Fields& fields) {
    auto& tile = definition_.tile;
    each(fields, "vertices", true, 3, tiling::max_tile_vertices,
         [&](const auto& entry, const auto& pointer) { tile.vertices.push_back(point(entry, pointer)); });
    each(fields, "edges", false, 0, tiling::max_tile_vertices, [&](const auto& entry, const auto& pointer) {
      auto& edge = tile.edges.emplace_back();
      Fields inner(entry, pointer, faults_);
      inner.required("shape");
      inner.integer("shape", edge.shape, 0, static_cast<int>(max_shapes) - 1);
      inner.boolean("turned", edge.turned);
      inner.boolean("mirrored", edge.mirrored);
      inner.finish();
    });
    std::size_t next = 0;
    each(fields, "translations", true, 2, 2,
         [&](const auto& entry, const auto& pointer) { tile.translations[next++] = point(entry, pointer); });
    each(fields, "placements", true, 1, tiling::max_placements, [&](const auto& entry, const auto& pointer) {
      auto& placement = tile.placements.emplace_back();
      Fields inner(entry, pointer, faults_);
      if (const auto* linear = inner.required("linear")) {
        Eigen::Vector4d entries = Eigen::Vector4d::Zero();
        if (read_components(*linear, inner.at("linear"), faults_, entries, -1, 1))
          std::copy(entries.begin(), entries.end(), placement.linear.begin());
      }
      if (const auto* offset = inner.required("offset")) placement.offset = point(*offset, inner.at("offset"));
      inner.finish();
    });
  }

  Fields& fields_;
  Faults& faults_;
  FamilyDefinition definition_;
};

void write(JsonWriter& out, const AffineExpression& expression) {
  if (expression.slopes.empty()) {
    out.number(expression.constant);
    return;
  }
  out.begin_array().number(expression.constant);
  for (const double slope : expression.slopes) out.number(slope);
  out.end_array();
}

void write(JsonWriter& out, const ExpressionPoint& point) {
  out.begin_array();
  write(out, point.x);
  write(out, point.y);
  out.end_array();
}

template <class Values>
void write_all(JsonWriter& out, std::string_view name, const Values& values) {
  out.key(name).begin_array();
  for (const auto& value : values) write(out, value);
  out.end_array();
}

void write_tile(JsonWriter& out, const tiling::TileDefinition& tile) {
  out.key("tile").begin_object();
  write_all(out, "vertices", tile.vertices);
  out.key("edges").begin_array();
  for (const auto& edge : tile.edges) {
    out.begin_object()
        .field("shape", edge.shape)
        .field("turned", edge.turned)
        .field("mirrored", edge.mirrored)
        .end_object();
  }
  out.end_array();
  write_all(out, "translations", tile.translations);
  out.key("placements").begin_array();
  for (const auto& placement : tile.placements) {
    out.begin_object().key("linear").numbers(placement.linear).key("offset");
    write(out, placement.offset);
    out.end_object();
  }
  out.end_array().end_object();
}

void write_shape(JsonWriter& out, const tiling::EdgeShape& shape) {
  out.begin_object().field("class", class_names.name_of(shape.symmetry));
  if (const auto* line = std::get_if<tiling::PolylineEdge>(&shape.line)) write_all(out, "points", line->points);
  if (const auto* curve = std::get_if<tiling::SineEdge>(&shape.line)) {
    write_all(out, "sines", curve->sines);
    out.field("pieces", curve->pieces);
  }
  out.end_object();
}

}  // namespace

FamilyDefinition read_family_definition(Fields& fields) { return DefinitionReader(fields).read(); }

FamilyDefinition parse_family_definition(std::string_view body, const Limits& limits,
                                         const CancellationToken& cancellation) {
  const auto document = parse_document(body, limits, cancellation);
  Faults faults(cancellation);
  Fields fields(document, "", faults);
  FamilyDefinition definition = read_family_definition(fields);
  fields.finish();
  faults.throw_if_any();
  return definition;
}

void write_family_definition(JsonWriter& out, const FamilyDefinition& definition) {
  out.begin_object().field("id", definition.id).field("description", definition.description);
  out.key("parameters").begin_array();
  for (const auto& [description, range] : definition.parameters) {
    out.begin_object()
        .field("description", description)
        .field("lower", range.lower)
        .field("upper", range.upper)
        .field("default", range.preset)
        .end_object();
  }
  out.end_array().key("beam_width");
  write(out, definition.beam_width);
  out.field("mesh_size", definition.sufficient_mesh_size);
  if (definition.isohedral_type != 0)
    out.field("isohedral_type", definition.isohedral_type);
  else
    write_tile(out, definition.tile);
  out.key("shapes").begin_array();
  for (const auto& shape : definition.shapes) write_shape(out, shape);
  out.end_array().end_object();
}

std::string write_family_definition(const FamilyDefinition& definition) {
  JsonWriter out;
  write_family_definition(out, definition);
  return out.take();
}

std::string write_isohedral_types() {
  JsonWriter out;
  out.begin_object().key("types").begin_array();
  for (const auto& type : tiling::isohedral_types()) {
    out.begin_object().field("number", type.number).key("defaults").numbers(type.defaults);
    out.key("classes").begin_array();
    for (const auto symmetry : type.symmetries) out.string(class_names.name_of(symmetry));
    out.end_array();
    write_tile(out, type.tile);
    out.end_object();
  }
  out.end_array().end_object();
  return out.take();
}

}  // namespace supple::json
