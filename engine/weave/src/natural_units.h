#pragma once

#include <optional>

#include "supple/weave/equilibrium.h"
#include "supple/weave/weave.h"

namespace supple::weave {

/// The units in which a weave is computed. Its mean length of rod between crossings is `mean_rod_length` units, and its
/// Young's modulus is that of the default material. Every tolerance, step and stiffness of the computation is a number
/// in these units, so that results scale with Young's modulus and with the layout's size.
struct NaturalUnits {
  double length = 1;   ///< unit of length, mm
  double modulus = 1;  ///< unit of Young's modulus, MPa

  double force() const { return modulus * length * length; }            ///< N
  double energy() const { return modulus * length * length * length; }  ///< N mm
  /// Unit of a force per length, such as a stiffness or a stress of the sheet, N/mm.
  double force_per_length() const { return modulus * length; }
};
/// The natural units of a weave, which must be valid.
NaturalUnits natural_units(const Weave& weave);

/// A weave in its natural units. It refers to the given weave if these units are mm and MPa, and holds a scaled copy
/// otherwise. O(pieces).
class NaturalWeave {
 public:
  /// `weave` must be valid and must outlive this object.
  explicit NaturalWeave(const Weave& weave);
  const NaturalUnits& units() const { return units_; }
  const Weave& weave() const { return scaled_ ? *scaled_ : *given_; }

 private:
  const Weave* given_;
  NaturalUnits units_;
  std::optional<Weave> scaled_;
};

/// The options with their lengths and stiffnesses converted to these units.
EquilibriumOptions in_natural_units(EquilibriumOptions options, const NaturalUnits& units);

}  // namespace supple::weave
