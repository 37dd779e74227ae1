#pragma once

#include <optional>

#include "supple/weave/equilibrium.h"
#include "supple/weave/weave.h"

namespace supple::weave {

/// The units in which a weave is computed: its mean length of rod between crossings is `mean_rod_length` units, and its
/// Young's modulus is that of the default material. Every tolerance, step and stiffness of the computation is a number
/// in these units. So results are proportional to Young's modulus, and to the right power of a factor that all lengths
/// have in common.
struct NaturalUnits {
  double length = 1;   ///< mm
  double modulus = 1;  ///< MPa

  double force() const { return modulus * length * length; }            ///< N
  double energy() const { return modulus * length * length * length; }  ///< N mm
  /// A force per length, such as a stiffness (N/mm) or a stress of the sheet.
  double force_per_length() const { return modulus * length; }
};
/// `weave` must be valid.
NaturalUnits natural_units(const Weave& weave);

/// A weave in its natural units. It is the given one where these are mm and MPa, and a copy otherwise. O(pieces).
class NaturalWeave {
 public:
  /// `weave` must be valid and outlive this.
  explicit NaturalWeave(const Weave& weave);
  const NaturalUnits& units() const { return units_; }
  const Weave& weave() const { return scaled_ ? *scaled_ : *given_; }

 private:
  const Weave* given_;
  NaturalUnits units_;
  std::optional<Weave> scaled_;
};

/// Lengths and stiffnesses of the options in these units.
EquilibriumOptions in_natural_units(EquilibriumOptions options, const NaturalUnits& units);

}  // namespace supple::weave
