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

/// The stiffnesses with which a strand resists deformation.
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

/// A strand's part in a crossing.
struct CrossingMember {
  int strand = 0;
  double coordinate = 0;        ///< arc length along the strand where the crossing is at rest, mm
  Eigen::Vector2i shift{0, 0};  ///< the member is the strand's copy that is moved by lattice * shift
  bool slides = false;          ///< whether the strand moves through the crossing along itself
  double backward = std::numeric_limits<double>::infinity();  ///< how far the coordinate may fall, mm
  double forward = std::numeric_limits<double>::infinity();   ///< how far it may rise, mm
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

/// Throws "weave.invalid_layout" with a detail for each fault: members that name no strand or a coordinate outside of
/// it or that do not meet (farther apart than 1e-6 of the extent); two crossings at one place of a strand; a shift
/// without a lattice; numbers out of range. O(crossings log crossings).
void validate(const Weave& weave, const Execution& execution = {});

/// The position of a member at rest, including its shift; mm.
Eigen::Vector2d rest_position(const Weave& weave, const CrossingMember& member);

/// How many crossings are found at most, which is as many as a request may list.
inline constexpr std::size_t most_crossings = 1'000'000;
/// How many pairs of pieces of strands are compared at most, which takes about a minute.
inline constexpr std::size_t most_near_pieces = 50'000'000;

/// Finds all crossings of the strands with each other, with every member fused. Crossings of a strand with itself are
/// not looked for. If more than two strands meet in one point, they form one crossing. The result is sorted by strands
/// and coordinates.
///
/// Those pieces of the curves are compared whose boxes meet, which a hierarchy of boxes finds. For n pieces, of which k
/// pairs lie near each other, this takes O((n + k) log n) for each copy of the cell that the strands reach. The search
/// looks for a stop request every few pieces, and reports progress.
///
/// Throws "weave.invalid_layout" with the detail "strands" as soon as more than `most_crossings` are found or more than
/// `most_near_pieces` pairs of pieces were compared.
std::vector<Crossing> find_crossings(const std::vector<Strand>& strands,
                                     const std::optional<Eigen::Matrix2d>& lattice = std::nullopt,
                                     const Execution& execution = {});

}  // namespace supple::weave
