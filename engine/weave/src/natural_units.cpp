#include "natural_units.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "rod_model.h"

namespace supple::weave {
namespace {

/// A unit that differs from 1 by less than this is 1 up to rounding.
constexpr double unit_rounding = 1e-12;

/// A crossing this close to the end of a strand, relative to the strand's length, is at the end.
constexpr double end_tolerance = 1e-7;

double rounded_unit(double unit) { return std::abs(unit - 1) < unit_rounding ? 1 : unit; }

Weave in_units(const Weave& weave, const NaturalUnits& units) {
  const double factor = 1 / units.length;
  Weave scaled;
  scaled.material = {Material{}.youngs_modulus, weave.material.poisson_ratio};
  scaled.strands.reserve(weave.strands.size());
  for (const Strand& strand : weave.strands)
    scaled.strands.push_back({strand.curve.scaled(factor), strand.radius * factor});
  scaled.crossings = weave.crossings;
  for (Crossing& crossing : scaled.crossings) {
    for (CrossingMember& member : crossing.members) {
      member.coordinate *= factor;
      member.backward *= factor;
      member.forward *= factor;
    }
  }
  if (weave.lattice) scaled.lattice = *weave.lattice * factor;
  return scaled;
}

}  // namespace

NaturalUnits natural_units(const Weave& weave) {
  double length = 0;
  std::ptrdiff_t rods = 0;
  for (const Strand& strand : weave.strands) {
    length += strand.curve.length();
    if (strand.curve.ends() == Ends::open) ++rods;
  }
  for (const Crossing& crossing : weave.crossings) {
    for (const CrossingMember& member : crossing.members) {
      const StrandCurve& curve = weave.strands[static_cast<std::size_t>(member.strand)].curve;
      const double to_end = std::min(member.coordinate, curve.length() - member.coordinate);
      if (curve.ends() != Ends::open || to_end > end_tolerance * curve.length()) ++rods;
    }
  }
  // A loop without crossings counts no rod above, so that the number may be 0.
  const double mean = length / static_cast<double>(std::max<std::ptrdiff_t>(rods, 1));
  return {rounded_unit(mean / mean_rod_length),
          rounded_unit(weave.material.youngs_modulus / Material{}.youngs_modulus)};
}

NaturalWeave::NaturalWeave(const Weave& weave) : given_(&weave), units_(natural_units(weave)) {
  if (units_.length != 1 || units_.modulus != 1) scaled_ = in_units(weave, units_);
}

EquilibriumOptions in_natural_units(EquilibriumOptions options, const NaturalUnits& units) {
  if (options.least_distance) *options.least_distance /= units.length;
  if (options.barrier_range) *options.barrier_range /= units.length;
  if (options.sliding_regularization) *options.sliding_regularization /= units.force_per_length();
  return options;
}

}  // namespace supple::weave
