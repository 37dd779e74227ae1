#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "supple/weave/strand_curve.h"

namespace supple::weave {

/// An isotropic material. The default is printed PLA.
struct Material {
  double youngs_modulus = 3500;  ///< MPa
  double poisson_ratio = 0.42;
};

/// What resists deformation of a strand.
struct Stiffness {
  double stretch = 0;  ///< EA, N
  double bend = 0;     ///< EI, N mm^2
  double twist = 0;    ///< GJ, N mm^2
};
/// Of a circular section: EA = E pi r^2, EI = E pi r^4 / 4, GJ = E / (2 (1 + nu)) pi r^4 / 2.
Stiffness circular(double radius, const Material& material);

struct Strand {
  StrandCurve curve;
  double radius = 0.25;  ///< mm
};

/// A strand's part in a crossing.
struct CrossingMember {
  int strand = 0;
  double coordinate = 0;        ///< arc length along the strand where the crossing is at rest, mm
  Eigen::Vector2i shift{0, 0};  ///< the strand's copy, moved by lattice * shift, that is meant
  bool slides = false;          ///< the strand moves through the crossing along itself
  double backward = std::numeric_limits<double>::infinity();  ///< how far the coordinate may fall, mm
  double forward = std::numeric_limits<double>::infinity();   ///< how far it may rise, mm
};

/// Where strands meet. Members that do not slide are fused: from two on, they turn together as one rigid joint. Members
/// that slide stay at the crossing and turn freely.
struct Crossing {
  std::vector<CrossingMember> members;
};

/// A layout of strands in the plane, at rest; of infinitely many copies where it has a lattice.
struct Weave {
  Material material{};
  std::vector<Strand> strands{};
  std::vector<Crossing> crossings{};
  /// Columns are the translations to the neighbouring cells, mm; of positive determinant.
  std::optional<Eigen::Matrix2d> lattice{};
};

/// Throws "weave.invalid_layout" with a detail for each fault: members that name no strand or a coordinate outside of
/// it or that do not meet (farther apart than 1e-6 of the extent); two crossings at one place of a strand; a shift
/// without a lattice; numbers out of range. O(crossings log crossings).
void validate(const Weave& weave);

/// The position of a member at rest, its shift included; mm.
Eigen::Vector2d rest_position(const Weave& weave, const CrossingMember& member);

/// All crossings of the weave's strands with each other (self-crossings are not looked for), every member fused; where
/// more than two meet in one point, they are one crossing. Sorted by strands and coordinates. Strands' boxes are swept
/// along x; of those that meet, pieces within both boxes are compared with each other. Throws
/// "weave.invalid_layout" where more than 2 million pairs of strands come that near.
std::vector<Crossing> find_crossings(const std::vector<Strand>& strands,
                                     const std::optional<Eigen::Matrix2d>& lattice = std::nullopt);

}  // namespace supple::weave
