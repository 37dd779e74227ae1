#include "definition_fields.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "defined_outline.h"
#include "supple/base/number_text.h"
#include "supple/tiling/isohedral_types.h"

namespace supple::tiling {
namespace {

constexpr std::size_t max_id_length = 32;
constexpr double max_sufficient_mesh_size = 2;  ///< beam widths
/// Largest coordinate of an edge's points in chord lengths.
constexpr double max_chord_coordinate = 10;
/// Largest deviation of a placement from an orthogonal matrix. Tables have twelve digits.
constexpr double orthogonality_tolerance = 1e-9;

/// The values that an expression has within the box.
struct Range {
  double lower, upper;
};

/// Collects the faults of a definition's fields, and which parameters its expressions depend on.
class FieldCheck {
 public:
  explicit FieldCheck(const FamilyDefinition& definition)
      : definition_(definition), used_(definition.parameters.size(), false) {}

  std::vector<DefinitionFinding> run() {
    check_names();
    check_parameters();
    // Ranges of expressions need a box.
    if (!faults_.empty()) return std::move(faults_);
    check_beam_width();
    check_tile();
    check_shapes();
    check_type();
    if (faults_.empty()) check_outline();
    if (faults_.empty()) check_use();
    return std::move(faults_);
  }

 private:
  void require(bool good, std::string where, std::string message, DefinitionFlaw flaw = DefinitionFlaw::field) {
    if (!good) faults_.push_back({flaw, std::move(where), std::move(message), {}, {}});
  }

  static std::string entry(std::string path, std::size_t index) {
    return std::move(path) + "/" + std::to_string(index);
  }

  void check_names() {
    const auto is_letter = [](char c) {
      return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    };
    const std::string& id = definition_.id;
    require(!id.empty() && id.size() <= max_id_length && std::all_of(id.begin(), id.end(), is_letter), "id",
            "must be 1 to 32 letters, digits, \"_\" or \"-\"");
    require(definition_.sufficient_mesh_size > 0 && definition_.sufficient_mesh_size <= max_sufficient_mesh_size,
            "mesh_size", "must be above 0 and at most " + number_text(max_sufficient_mesh_size));
  }

  void check_parameters() {
    require(definition_.parameters.size() <= max_defined_parameters, "parameters",
            "must be at most " + std::to_string(max_defined_parameters) + ", but are " +
                std::to_string(definition_.parameters.size()));
    for (std::size_t k = 0; k < definition_.parameters.size(); ++k) {
      const auto& [lower, upper, preset] = definition_.parameters[k].range;
      const auto bounded = [](double value) { return std::abs(value) <= max_coordinate; };
      const std::string where = entry("parameters", k);
      require(bounded(lower) && bounded(upper), where,
              "must have bounds between -" + number_text(max_coordinate) + " and " + number_text(max_coordinate));
      require(lower < upper, where, "must have a lower bound below its upper one");
      require(preset >= lower && preset <= upper, where, "must have a default within its bounds");
    }
  }

  Range range_of(const AffineExpression& expression) const {
    double middle = expression.constant, reach = 0;
    for (std::size_t k = 0; k < expression.slopes.size(); ++k) {
      const Parameter& range = definition_.parameters[k].range;
      middle += expression.slopes[k] * (range.lower + range.upper) / 2;
      reach += std::abs(expression.slopes[k]) * (range.upper - range.lower) / 2;
    }
    return {middle - reach, middle + reach};
  }

  /// Whether the expression is one of the definition's parameters; notes those that it depends on.
  bool examine(const AffineExpression& expression, const std::string& where, double max) {
    const auto finite = [](double value) { return std::isfinite(value); };
    const bool fits = expression.slopes.size() <= definition_.parameters.size();
    require(fits, where, "has more factors than there are parameters");
    const bool is_finite =
        finite(expression.constant) && std::all_of(expression.slopes.begin(), expression.slopes.end(), finite);
    require(is_finite, where, "must be finite");
    if (!fits || !is_finite) return false;
    for (std::size_t k = 0; k < expression.slopes.size(); ++k) used_[k] = used_[k] || expression.slopes[k] != 0;
    const auto [lower, upper] = range_of(expression);
    const double largest = std::max(std::abs(lower), std::abs(upper));
    require(largest <= max, where,
            "must lie between -" + number_text(max) + " and " + number_text(max) +
                " for all parameters within their bounds, but becomes " +
                number_text(std::abs(upper) == largest ? upper : lower),
            DefinitionFlaw::too_large);
    return largest <= max;
  }

  void examine(const ExpressionPoint& point, const std::string& where, double max) {
    examine(point.x, where + "/0", max);
    examine(point.y, where + "/1", max);
  }

  void check_beam_width() {
    if (!examine(definition_.beam_width, "beam_width", max_coordinate)) return;
    const double narrowest = range_of(definition_.beam_width).lower;
    require(narrowest > 0, "beam_width",
            "must be positive for all parameters within their bounds, but becomes " + number_text(narrowest));
  }

  void check_tile() {
    const TileDefinition& tile = definition_.tile;
    require(tile.vertices.size() >= 3 && tile.vertices.size() <= max_tile_vertices, "tile/vertices",
            "must be 3 to " + std::to_string(max_tile_vertices) + ", but are " + std::to_string(tile.vertices.size()));
    for (std::size_t k = 0; k < tile.vertices.size(); ++k)
      examine(tile.vertices[k], entry("tile/vertices", k), max_coordinate);
    for (std::size_t k = 0; k < 2; ++k) examine(tile.translations[k], entry("tile/translations", k), max_coordinate);
    require(!tile.placements.empty() && tile.placements.size() <= max_placements, "tile/placements",
            "must be 1 to " + std::to_string(max_placements) + ", but are " + std::to_string(tile.placements.size()));
    for (std::size_t k = 0; k < tile.placements.size(); ++k) {
      const std::string where = entry("tile/placements", k);
      const auto& [a, b, c, d] = tile.placements[k].linear;
      const Eigen::Matrix2d linear{{a, b}, {c, d}};
      require((linear * linear.transpose()).isIdentity(orthogonality_tolerance), where + "/linear",
              "must be a rotation or a reflection");
      examine(tile.placements[k].offset, where + "/offset", max_coordinate);
    }
    require(tile.edges.empty() || tile.edges.size() == tile.vertices.size(), "tile/edges",
            "must be none, or one for each of the " + std::to_string(tile.vertices.size()) + " vertices");
    for (std::size_t k = 0; k < tile.edges.size(); ++k) {
      const int shape = tile.edges[k].shape;
      require(shape >= 0 && shape < static_cast<int>(definition_.shapes.size()), entry("tile/edges", k) + "/shape",
              "must be below " + std::to_string(definition_.shapes.size()) + ", the number of shapes");
    }
  }

  void check_shapes() {
    for (std::size_t k = 0; k < definition_.shapes.size(); ++k) {
      const EdgeShape& shape = definition_.shapes[k];
      const std::string where = entry("shapes", k);
      if (shape.symmetry == EdgeSymmetry::straight) {
        require(std::holds_alternative<StraightEdge>(shape.line), where,
                "is of the class I, which is straight, and has points or sines");
      } else if (const auto* line = std::get_if<PolylineEdge>(&shape.line)) {
        check_polyline(*line, where + "/points");
      } else if (const auto* curve = std::get_if<SineEdge>(&shape.line)) {
        check_curve(*curve, shape.symmetry, where);
      }
      const auto& edges = definition_.tile.edges;
      require(std::any_of(edges.begin(), edges.end(),
                          [&](const TileEdge& edge) { return edge.shape == static_cast<int>(k); }),
              where, "is the shape of no edge", DefinitionFlaw::unused);
    }
  }

  void check_polyline(const PolylineEdge& line, const std::string& where) {
    require(line.points.size() <= max_polyline_points, where, "must be at most " + std::to_string(max_polyline_points));
    for (std::size_t k = 0; k < line.points.size(); ++k) examine(line.points[k], entry(where, k), max_chord_coordinate);
  }

  void check_curve(const SineEdge& curve, EdgeSymmetry symmetry, const std::string& where) {
    require(curve.sines.size() <= max_sines, where + "/sines", "must be at most " + std::to_string(max_sines));
    require(curve.pieces >= min_sine_pieces && curve.pieces <= max_sine_pieces, where + "/pieces",
            "must be " + std::to_string(min_sine_pieces) + " to " + std::to_string(max_sine_pieces));
    for (std::size_t k = 0; k < curve.sines.size(); ++k) {
      const AffineExpression& sine = curve.sines[k];
      const std::string at = entry(where + "/sines", k);
      examine(sine, at, max_chord_coordinate);
      const bool odd = k % 2 == 0;  // the first one is sin(pi x)
      const bool allowed = symmetry == EdgeSymmetry::any || (symmetry == EdgeSymmetry::mirror_symmetric) == odd;
      const auto vanishes = [](double value) { return value == 0; };
      const bool zero = sine.constant == 0 && std::all_of(sine.slopes.begin(), sine.slopes.end(), vanishes);
      require(allowed || zero, at, odd ? "must be 0 in an edge of the class S" : "must be 0 in an edge of the class U");
    }
  }

  void check_type() {
    if (definition_.isohedral_type == 0) return;
    const IsohedralType* type = find_isohedral_type(definition_.isohedral_type);
    require(type, "isohedral_type", "must be the number of one of the 81 types");
    if (!type) return;
    require(definition_.tile == type->tile, "tile", "must be that of the isohedral type");
    require(definition_.shapes.size() == type->symmetries.size(), "shapes",
            "must be " + std::to_string(type->symmetries.size()) + ", as many as the isohedral type has");
    for (std::size_t k = 0; k < std::min(definition_.shapes.size(), type->symmetries.size()); ++k) {
      const EdgeSymmetry allowed = type->symmetries[k], given = definition_.shapes[k].symmetry;
      require(given == allowed || given == EdgeSymmetry::straight || allowed == EdgeSymmetry::any,
              entry("shapes", k) + "/class",
              std::string("must be ") + name_of(allowed) + " in this isohedral type, or I");
    }
  }

  static const char* name_of(EdgeSymmetry symmetry) {
    switch (symmetry) {
      case EdgeSymmetry::any:
        return "J";
      case EdgeSymmetry::point_symmetric:
        return "S";
      case EdgeSymmetry::mirror_symmetric:
        return "U";
      default:
        return "I";
    }
  }

  void check_outline() {
    const std::size_t points = edge_starts(definition_).back();
    require(points <= max_outline_points, "tile",
            "must have at most " + std::to_string(max_outline_points) +
                " points, those of its edges included, but has " + std::to_string(points));
  }

  void check_use() {
    for (std::size_t k = 0; k < used_.size(); ++k)
      require(used_[k], entry("parameters", k), "is a parameter that nothing depends on", DefinitionFlaw::unused);
  }

  const FamilyDefinition& definition_;
  std::vector<bool> used_;
  std::vector<DefinitionFinding> faults_;
};

}  // namespace

std::vector<DefinitionFinding> field_faults(const FamilyDefinition& definition) { return FieldCheck(definition).run(); }

}  // namespace supple::tiling
