#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "supple/base/execution.h"
#include "supple/weave/strand_curve.h"

namespace supple::weave {

/// An isotropic material. The default is printed PLA.
struct Material {
  double youngs_modulus = 3500;  ///< MPa
  double poisson_ratio = 0.42;
};

/// The stiffnesses of a strand.
struct Stiffness {
  double stretch = 0;  ///< EA, N
  double bend = 0;     ///< EI, N mm^2
  double twist = 0;    ///< GJ, N mm^2
};
/// The stiffnesses of a circular section: EA = E pi r^2, EI = E pi r^4 / 4, GJ = E / (2 (1 + nu)) pi r^4 / 2.
Stiffness circular(double radius, const Material& material);

struct Strand {
  StrandCurve curve;
  double radius = 0.25;  ///< mm
};

/// A strand that takes part in a crossing.
struct CrossingMember {
  int strand = 0;
  double coordinate = 0;        ///< arc length along the strand of the crossing's position at rest, mm
  Eigen::Vector2i shift{0, 0};  ///< the member is the copy of the strand that is translated by lattice * shift
  bool slides = false;          ///< whether the strand moves through the crossing along its own axis
  double backward = std::numeric_limits<double>::infinity();  ///< maximum decrease of the coordinate by sliding, mm
  double forward = std::numeric_limits<double>::infinity();   ///< maximum increase of the coordinate by sliding, mm
};

/// A place where strands meet. Members that do not slide are fused: two or more of them turn together as one rigid
/// joint. Members that slide stay at the crossing and turn freely.
struct Crossing {
  std::vector<CrossingMember> members;
};

/// A layout of strands in the plane, at rest. If it has a lattice, it stands for infinitely many copies.
struct Weave {
  Material material{};
  std::vector<Strand> strands{};
  std::vector<Crossing> crossings{};
  /// The columns are the translations to the neighbouring cells, mm. The determinant is positive.
  std::optional<Eigen::Matrix2d> lattice{};
};

/// Throws "weave.invalid_layout" with a detail for each fault:
/// - a member that names no strand, or a coordinate outside of its strand;
/// - members that do not meet (farther apart than 1e-6 of the extent);
/// - two crossings at one place of a strand;
/// - a shift without a lattice;
/// - a number out of range.
/// O(crossings log crossings).
void validate(const Weave& weave, const Execution& execution = {});

/// The position of a member at rest, including its shift; mm.
Eigen::Vector2d rest_position(const Weave& weave, const CrossingMember& member);

/// Maximum number of crossings that are found, which is as many as a request may list.
inline constexpr std::size_t max_crossings = 1'000'000;
/// Maximum number of pairs of pieces of strands that are compared, which takes about a minute.
inline constexpr std::size_t max_near_pairs = 50'000'000;

/// Finds all crossings of the strands with each other, with every member fused. Crossings of a strand with itself are
/// not looked for. If more than two strands meet in one point, they form one crossing. The result is sorted by strands
/// and coordinates.
///
/// A hierarchy of bounding boxes finds the pieces of the curves whose boxes overlap, and only these are compared. For n
/// pieces, of which k pairs lie near each other, this takes O((n + k) log n) for each copy of the cell that the strands
/// reach. The search checks for a stop request every few pieces, and reports progress.
///
/// Throws "weave.invalid_layout" with the detail "strands" as soon as more than `max_crossings` are found or more than
/// `max_near_pairs` pairs of pieces were compared.
std::vector<Crossing> find_crossings(const std::vector<Strand>& strands,
                                     const std::optional<Eigen::Matrix2d>& lattice = std::nullopt,
                                     const Execution& execution = {});

}  // namespace supple::weave
