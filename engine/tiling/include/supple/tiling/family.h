#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace supple::tiling {

/// Vertices of a closed polygon in order; the last is joined to the first.
using Polygon = std::vector<Eigen::Vector2d>;

/// Where a copy of a tile lies: a point x of the tile goes to linear * x + offset. `linear` is orthogonal (a rotation
/// or a reflection).
struct Placement {
  int tile = 0;  ///< index into Tiling::tiles
  Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
};

/// A periodic tiling of the plane, in tiling units: the placed tiles make one cell, and the cell's translates by the
/// columns of `lattice` fill the plane without gaps or overlaps. Tiles meet edge to edge.
struct Tiling {
  std::vector<Polygon> tiles;         ///< counterclockwise; isohedral families have one tile
  std::vector<Placement> placements;  ///< the tiles of one cell
  Eigen::Matrix2d lattice;            ///< columns: the two translations
};

struct Parameter {
  double lower = 0;
  double upper = 0;
  double preset = 0;  ///< the family's default, within the bounds
};

/// Length of a triangle's side away from corners, in beam widths, unless a mesh asks for another one.
inline constexpr double default_mesh_size = 0.5;

struct FamilyDefinition;

/// A family of tilings: data and, through `shape`, the tiling at given parameters. `make_family` makes it from a
/// definition, which is what a family's file holds (models/families).
struct Family {
  std::string id;  ///< e.g. "IH21"
  std::string description;
  std::vector<Parameter> parameters;
  double beam_width = 0;  ///< in tiling units, at the default parameters; scaled to printed_beam_width
  /// Mesh size, in beam widths, that suffices for data sets of the family. It is larger than the default in cells of
  /// many slender beams, which deform by bending along their length.
  double sufficient_mesh_size = default_mesh_size;
  /// Whether tiles whose hole closes are part of the family. This is so for the family with a topological singularity.
  bool holes_may_close = false;
  std::function<Tiling(std::span<const double>)> shape;  ///< the tiling at parameters, which `tiling_of` checks
  /// What the family was made from; null if `shape` is code, as that of "square" is.
  std::shared_ptr<const FamilyDefinition> definition = nullptr;
};

/// The width of a beam to which structures are scaled, as it is printed, in millimetres.
inline constexpr double printed_beam_width = 0.3;

/// All families: IH01, IH21, IH22, IH28, IH29, IH50, IH67 and "square", whose topology changes at p = 0
/// [Thesis, section 4.4.3].
const std::vector<Family>& families();

/// The family with an id, or null.
const Family* find_family(std::string_view id);

/// The family with an id. Throws "tiling.family_not_found", which lists all families.
const Family& family(std::string_view id);

/// The default parameters of a family.
std::vector<double> presets(const Family& family);

/// The width of the beams at these parameters, in tiling units. It is `beam_width` unless the family's definition makes
/// it depend on the parameters.
double beam_width_at(const Family& family, std::span<const double> parameters);

/// The same family with beams that are wider by this factor at all parameters.
Family with_beam_width_factor(const Family& family, double factor);

/// Checks the parameters and makes the tiling. Throws "tiling.parameter_count", "tiling.parameter_out_of_bounds" (which
/// names each parameter with its bounds and value) and "tiling.cell_too_small" (a tile has less than 10 % of the area
/// of the default tile, and the family's holes may not close). `box_margin` widens the bounds by this fraction of their
/// width on either side, because training data surround the box. A tile's outline may cross itself; see
/// `make_structure`.
Tiling tiling_of(const Family& family, std::span<const double> parameters, double box_margin = 0);

}  // namespace supple::tiling
