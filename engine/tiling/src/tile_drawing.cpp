#include "supple/tiling/tile_drawing.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

#include "box_survey.h"
#include "drawn_edges.h"
#include "polygon.h"
#include "supple/tiling/isohedral_types.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {
namespace {

/// Angle by which an outline turns at a corner at least; less belongs to a curve.
constexpr double min_turn = 12 * std::numbers::pi / 180;
/// Choices of vertices among the corners that are tried.
constexpr double max_choices = 20'000;
/// Area of the tiles within the bounds, divided by that of the drawn one. There are no structures of smaller tiles.
constexpr double min_relative_area = 0.1;
/// Points of the bounds at which the area is looked at, beside the default and the corners.
constexpr int area_samples = 64;
constexpr int max_halvings = 20;

[[noreturn]] void refuse(const std::ostringstream& message) {
  throw TilingError("tiling.drawing", message.str(), {{"svg", message.str()}});
}

std::string name_of(int type) { return std::string(type < 10 ? "IH0" : "IH") + std::to_string(type); }

/// The corners of an outline, at which it turns.
std::vector<std::size_t> corners_of(const Polygon& outline) {
  std::vector<std::size_t> corners;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d before = outline[k] - outline[(k + outline.size() - 1) % outline.size()];
    const Eigen::Vector2d after = outline[(k + 1) % outline.size()] - outline[k];
    if (std::abs(std::atan2(cross(before, after), before.dot(after))) > min_turn) corners.push_back(k);
  }
  return corners;
}

/// Vertices of a tile among the points of an outline, with what makes the type's tile like the drawn one.
struct VertexChoice {
  std::vector<std::size_t> vertices;  ///< point of the outline for each vertex of the type
  Eigen::VectorXd parameters;
  double vertex_misfit = INFINITY;  ///< as in max_vertex_misfit
  double edge_misfit = INFINITY;    ///< as in max_edge_misfit
  double departure = 0;             ///< distance of the parameters from the type's defaults
  bool reflected = false;
};

/// Fits the vertices of a type to points of an outline: a z + b = c + sum over k of p_k s_k, for the points z and the
/// vertices' constants c and slopes s, as complex numbers. It is linear in a, b and the parameters p.
class VertexFit {
 public:
  VertexFit(const IsohedralType& type, const Polygon& outline) : type_(type), outline_(outline) {}

  void fit(VertexChoice& choice) const {
    const auto n = static_cast<Eigen::Index>(type_.tile.vertices.size());
    const auto parameters = static_cast<Eigen::Index>(type_.defaults.size());
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(2 * n, 4 + parameters);
    Eigen::VectorXd constants(2 * n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto& vertex = type_.tile.vertices[static_cast<std::size_t>(k)];
      const Eigen::Vector2d z = outline_[choice.vertices[static_cast<std::size_t>(k)]];
      system.block<2, 4>(2 * k, 0) << z.x(), -z.y(), 1, 0, z.y(), z.x(), 0, 1;
      subtract_slopes(system, 2 * k, vertex.x);
      subtract_slopes(system, 2 * k + 1, vertex.y);
      constants.segment<2>(2 * k) << vertex.x.constant, vertex.y.constant;
    }
    const Eigen::VectorXd found = system.completeOrthogonalDecomposition().solve(constants);
    const double scale = found.head<2>().norm();
    choice.parameters = found.tail(parameters);
    choice.departure =
        (choice.parameters - Eigen::Map<const Eigen::VectorXd>(type_.defaults.data(), parameters)).norm();
    choice.vertex_misfit = (system * found - constants).norm() / std::sqrt(static_cast<double>(n)) /
                           std::max(scale * std::sqrt(area(outline_)), 1e-9);
  }

 private:
  static void subtract_slopes(Eigen::MatrixXd& system, Eigen::Index row, const AffineExpression& expression) {
    for (std::size_t k = 0; k < expression.slopes.size(); ++k)
      system(row, 4 + static_cast<Eigen::Index>(k)) = -expression.slopes[k];
  }

  const IsohedralType& type_;
  const Polygon& outline_;
};

/// The lines of all edges as their shapes have them.
std::vector<ChordLine> shape_lines(const IsohedralType& type, const Polygon& outline, const VertexChoice& choice) {
  std::vector<ChordLine> lines;
  const auto& vertices = choice.vertices;
  for (std::size_t k = 0; k < vertices.size(); ++k)
    lines.push_back(shape_line(outline, vertices[k], vertices[(k + 1) % vertices.size()], type.tile.edges[k]));
  return lines;
}

/// What is worst about the edges: how far they are from the first one with their shape, or from their symmetry.
struct EdgeMisfit {
  double value = 0;
  std::size_t edge = 0;
  std::size_t like = 0;  ///< the edge that it should be like; itself where its symmetry is meant
};

EdgeMisfit edge_misfit(const IsohedralType& type, const std::vector<ChordLine>& lines) {
  EdgeMisfit worst;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const int shape = type.tile.edges[k].shape;
    std::size_t first = 0;
    while (type.tile.edges[first].shape != shape) ++first;
    const double value = first == k ? symmetry_misfit(type.symmetries[static_cast<std::size_t>(shape)], lines[k])
                                    : line_distance(lines[first], lines[k]);
    if (value > worst.value) worst = {value, k, first};
  }
  return worst;
}

/// Calls call(chosen) for each choice of `count` of the corners in their order.
template <class Call>
void for_each_choice(const std::vector<std::size_t>& corners, std::size_t count, const Call& call) {
  std::vector<std::size_t> indices(count);
  for (std::size_t k = 0; k < count; ++k) indices[k] = k;
  while (true) {
    std::vector<std::size_t> chosen;
    chosen.reserve(count);
    for (const std::size_t index : indices) chosen.push_back(corners[index]);
    call(chosen);
    std::size_t k = count;
    while (k > 0 && indices[k - 1] == corners.size() - count + k - 1) --k;
    if (k == 0) return;
    ++indices[k - 1];
    for (std::size_t j = k; j < count; ++j) indices[j] = indices[j - 1] + 1;
  }
}

double number_of_choices(std::size_t corners, std::size_t count) {
  double choices = static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k) choices *= static_cast<double>(corners - k) / static_cast<double>(k + 1);
  return choices;
}

/// Weight of the distance of the parameters from the type's defaults. It decides between choices that fit equally well,
/// such as images of each other under a symmetry of the tile.
constexpr double weight_of_departure = 1e-4;

/// Whether the first choice fits better: the edges decide among those whose vertices fit.
bool is_better(const VertexChoice& a, const VertexChoice& b) {
  const bool fits = a.vertex_misfit <= max_vertex_misfit;
  if (fits != (b.vertex_misfit <= max_vertex_misfit)) return fits;
  const auto misfit = [](const VertexChoice& choice) {
    return choice.edge_misfit + choice.vertex_misfit + weight_of_departure * choice.departure;
  };
  return fits ? misfit(a) < misfit(b) : a.vertex_misfit < b.vertex_misfit;
}

void search(const IsohedralType& type, const Polygon& outline, bool reflected, const Execution& execution,
            VertexChoice& best) {
  const std::size_t count = type.tile.vertices.size();
  const VertexFit fit(type, outline);
  for_each_choice(corners_of(outline), count, [&](std::vector<std::size_t> chosen) {
    execution.checkpoint(reflected ? 0.25 : 0, "matching");
    for (std::size_t turn = 0; turn < count; ++turn) {
      VertexChoice choice{.vertices = chosen, .parameters = {}, .reflected = reflected};
      fit.fit(choice);
      if (choice.vertex_misfit <= max_vertex_misfit)
        choice.edge_misfit = edge_misfit(type, shape_lines(type, outline, choice)).value;
      if (is_better(choice, best)) best = std::move(choice);
      std::rotate(chosen.begin(), chosen.begin() + 1, chosen.end());
    }
  });
}

Polygon reflection(Polygon outline) {
  for (auto& point : outline) point.y() = -point.y();
  std::reverse(outline.begin(), outline.end());
  return outline;
}

void require_corners(const IsohedralType& type, const Polygon& outline) {
  const std::size_t corners = corners_of(outline).size();
  const std::size_t count = type.tile.vertices.size();
  std::ostringstream message;
  if (corners < count) {
    message << "The drawn tile has " << corners << " corners of more than 12 degrees, but the tile of "
            << name_of(type.number) << " has " << count << " vertices; each must be a corner.";
    refuse(message);
  }
  if (number_of_choices(corners, count) > max_choices) {
    message << "The drawn tile has " << corners << " corners, too many to find the " << count
            << " vertices of the tile of " << name_of(type.number) << " among them; draw its edges smoother.";
    refuse(message);
  }
}

void require_fit(const IsohedralType& type, const Polygon& outline, const VertexChoice& best) {
  std::ostringstream message;
  message.precision(2);
  if (best.vertex_misfit > max_vertex_misfit) {
    message << "The corners of the drawn tile are no vertices of a tile of " << name_of(type.number)
            << ": the best choice deviates by " << 100 * best.vertex_misfit << " % of the tile's size, the limit is "
            << 100 * max_vertex_misfit << " %.";
    refuse(message);
  }
  const auto misfit = edge_misfit(type, shape_lines(type, outline, best));
  if (misfit.value <= max_edge_misfit) return;
  const auto place = [&](std::size_t edge) {
    const auto& from = outline[best.vertices[edge]];
    const auto& to = outline[best.vertices[(edge + 1) % best.vertices.size()]];
    std::ostringstream text;
    text << "the edge from (" << from.x() << ", " << (best.reflected ? -from.y() : from.y()) << ") to (" << to.x()
         << ", " << (best.reflected ? -to.y() : to.y()) << ")";
    return text.str();
  };
  message << "In a tile of " << name_of(type.number) << " " << place(misfit.edge);
  if (misfit.like != misfit.edge) {
    message << " has the shape of " << place(misfit.like) << ", but differs from it by ";
  } else {
    const auto symmetry = type.symmetries[static_cast<std::size_t>(type.tile.edges[misfit.edge].shape)];
    message << (symmetry == EdgeSymmetry::straight          ? " is straight"
                : symmetry == EdgeSymmetry::point_symmetric ? " looks the same after half a turn"
                                                            : " is its own mirror image")
            << ", but the drawn one deviates from that by ";
  }
  message << 100 * misfit.value << " % of its length; the limit is " << 100 * max_edge_misfit << " %.";
  refuse(message);
}

double smallest_area(const FamilyDefinition& definition) {
  double smallest = INFINITY;
  for (const auto& sample : box_samples(definition, area_samples))
    smallest = std::min(smallest, area(tiling_at(definition, sample).tiles.front()));
  return smallest;
}

/// Halves the distance of the bounds of the first `count` parameters, which move vertices, from the defaults until no
/// tile within them is too small. Some types have parameters that move a vertex by ten times their own change. Where
/// the area vanishes, the translations are parallel, and beyond that the tile's copies overlap.
void narrow_bounds(FamilyDefinition& definition, std::size_t count, double drawn_area) {
  for (int halving = 0; halving < max_halvings; ++halving) {
    if (smallest_area(definition) >= min_relative_area * drawn_area) return;
    for (std::size_t k = 0; k < count; ++k) {
      auto& [lower, upper, preset] = definition.parameters[k].range;
      lower = (lower + preset) / 2;
      upper = (upper + preset) / 2;
    }
  }
}

/// Makes the height of a shape proportional to a new parameter, which is 1 for the drawn one.
void add_shape_parameter(FamilyDefinition& definition, EdgeShape& shape) {
  auto* const line = std::get_if<PolylineEdge>(&shape.line);
  if (!line || definition.parameters.size() == max_defined_parameters) return;
  const std::size_t index = definition.parameters.size();
  definition.parameters.push_back({"Height of a curved edge, relative to the drawn one", {0.5, 1.5, 1}});
  for (auto& point : line->points) {
    const double height = point.y.constant;
    point.y = 0;
    point.y.slopes.assign(index + 1, 0);
    point.y.slopes[index] = height;
  }
}

}  // namespace

FamilyDefinition definition_of_drawing(const TileDrawing& drawing, const Execution& execution) {
  const StageTimer timer(execution.cost, "matching");
  const IsohedralType* const type = find_isohedral_type(drawing.isohedral_type);
  std::ostringstream message;
  if (!type) {
    message << "There is no isohedral type " << drawing.isohedral_type << ".";
    refuse(message);
  }
  Polygon outline = drawing.outline;
  if (area(outline) < 0) std::reverse(outline.begin(), outline.end());
  require_corners(*type, outline);
  const Polygon reflected = reflection(outline);
  VertexChoice best;
  search(*type, outline, false, execution, best);
  search(*type, reflected, true, execution, best);
  const Polygon& matched = best.reflected ? reflected : outline;
  require_fit(*type, matched, best);

  FamilyDefinition definition = definition_of(*type, drawing.reach, 1);
  definition.id = drawing.id;
  definition.description = drawing.description;
  for (std::size_t k = 0; k < type->defaults.size(); ++k) {
    const double preset = best.parameters[static_cast<Eigen::Index>(k)];
    definition.parameters[k].range = {preset - drawing.reach, preset + drawing.reach, preset};
  }
  const auto lines = shape_lines(*type, matched, best);
  const int max_points = max_outline_points / static_cast<int>(lines.size()) - 1;
  for (std::size_t k = lines.size(); k-- > 0;) {
    const auto shape = static_cast<std::size_t>(type->tile.edges[k].shape);
    definition.shapes[shape] = shape_of_line(type->symmetries[shape], lines[k], max_points);
  }
  if (drawing.has_shape_parameters)
    for (auto& shape : definition.shapes) add_shape_parameter(definition, shape);
  std::vector<double> presets;
  for (const auto& parameter : definition.parameters) presets.push_back(parameter.range.preset);
  const double drawn_area = area(tiling_at(definition, presets).tiles.front());
  narrow_bounds(definition, type->defaults.size(), drawn_area);
  definition.beam_width = drawing.beam_width.value_or(0.05 * std::sqrt(std::abs(drawn_area)));
  return definition;
}

}  // namespace supple::tiling
