#include "supple/tiling/isohedral_types.h"

#include <algorithm>
#include <cstdio>

#include "isohedral_table.h"

namespace supple::tiling {
namespace {

/// Reads the numbers of a row in their order.
class RowReader {
 public:
  explicit RowReader(const IsohedralRow& row)
      : numbers_(row.numbers), parameters_(static_cast<std::size_t>(row.parameters)) {}

  double number() { return numbers_[next_++]; }

  AffineExpression expression() {
    AffineExpression result;
    for (std::size_t k = 0; k < parameters_; ++k) result.slopes.push_back(number());
    result.constant = number();
    while (!result.slopes.empty() && result.slopes.back() == 0) result.slopes.pop_back();
    return result;
  }

  ExpressionPoint point() {
    AffineExpression x = expression();
    return {std::move(x), expression()};
  }

 private:
  std::span<const double> numbers_;
  std::size_t parameters_;
  std::size_t next_ = 0;
};

EdgeSymmetry symmetry_of(char edge_class) {
  switch (edge_class) {
    case 'J':
      return EdgeSymmetry::any;
    case 'S':
      return EdgeSymmetry::point_symmetric;
    case 'U':
      return EdgeSymmetry::mirror_symmetric;
    default:
      return EdgeSymmetry::straight;
  }
}

/// Reads the edges of a row, such as "Ja Sb Jatm".
void read_edges(std::string_view text, IsohedralType& type) {
  while (!text.empty()) {
    const std::string_view edge = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), edge.size() + 1));
    const int shape = edge[1] - 'a';
    if (shape == static_cast<int>(type.symmetries.size())) type.symmetries.push_back(symmetry_of(edge[0]));
    type.tile.edges.push_back(
        {shape, edge.find('t') != std::string_view::npos, edge.find('m') != std::string_view::npos});
  }
}

IsohedralType read_type(const IsohedralRow& row) {
  IsohedralType type;
  type.number = row.number;
  read_edges(row.edges, type);
  RowReader reader(row);
  for (int k = 0; k < row.parameters; ++k) type.defaults.push_back(reader.number());
  for (std::size_t k = 0; k < type.tile.edges.size(); ++k) type.tile.vertices.push_back(reader.point());
  for (ExpressionPoint& translation : type.tile.translations) translation = reader.point();
  for (int k = 0; k < row.placements; ++k) {
    DefinedPlacement placement;
    for (double& entry : placement.linear) entry = reader.number();
    placement.offset = reader.point();
    type.tile.placements.push_back(placement);
  }
  return type;
}

}  // namespace

const std::vector<IsohedralType>& isohedral_types() {
  static const std::vector<IsohedralType> types = [] {
    std::vector<IsohedralType> result;
    for (const IsohedralRow& row : isohedral_rows()) result.push_back(read_type(row));
    return result;
  }();
  return types;
}

const IsohedralType* find_isohedral_type(int number) {
  const auto& types = isohedral_types();
  const auto found = std::find_if(types.begin(), types.end(), [&](const auto& type) { return type.number == number; });
  return found == types.end() ? nullptr : &*found;
}

FamilyDefinition definition_of(const IsohedralType& type, double reach, double beam_width) {
  FamilyDefinition definition;
  char id[16];
  std::snprintf(id, sizeof id, "IH%02d", type.number);
  definition.id = id;
  definition.description = std::string("Isohedral type ") + id;
  definition.beam_width = beam_width;
  definition.isohedral_type = type.number;
  definition.tile = type.tile;
  for (const EdgeSymmetry symmetry : type.symmetries) definition.shapes.push_back({symmetry, StraightEdge{}});
  for (std::size_t k = 0; k < type.defaults.size(); ++k) {
    const double preset = type.defaults[k];
    definition.parameters.push_back(
        {"Vertex parameter " + std::to_string(k + 1) + " of the type", {preset - reach, preset + reach, preset}});
  }
  return definition;
}

}  // namespace supple::tiling
