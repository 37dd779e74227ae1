#include "supple/weave/weave.h"
#include "supple/base/faults.h"
#include "supple/base/number_text.h"
#include "supple/weave/weave_error.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

namespace supple::weave {
namespace {

/// Members of one crossing lie this close together, relative to the layout's extent.
constexpr double same_position = 1e-6;
/// Minimum distance between two crossings of one strand, relative to the strand's length.
constexpr double same_coordinate = 1e-7;
/// Crossings that are validated between two checks for a stop request: some milliseconds.
constexpr std::size_t crossings_between_checks = 1024;

double extent(const Weave& weave) {
  Eigen::AlignedBox2d box;
  for (const Strand& strand : weave.strands)
    for (const double s : strand.curve.point_coordinates()) box.extend(strand.curve.at(s).position);
  return std::max(box.isEmpty() ? 0.0 : box.diagonal().norm(), 1e-9);
}

std::string place(std::size_t crossing, std::size_t member) {
  return "crossings/" + std::to_string(crossing) + "/members/" + std::to_string(member);
}

/// Checks a member. Texts are made for faults only: for a million members they would take longer than all the rest.
void check_member(const Weave& weave, const CrossingMember& member, std::size_t crossing, std::size_t index,
                  Faults& faults) {
  if (!(member.strand >= 0 && member.strand < static_cast<int>(weave.strands.size())))
    return faults.add(place(crossing, index) + "/strand", "names no strand");
  const StrandCurve& curve = weave.strands[static_cast<std::size_t>(member.strand)].curve;
  if (!(member.coordinate >= 0 && member.coordinate <= curve.length()))
    faults.add(place(crossing, index) + "/coordinate",
               "must lie within [0, " + number_text(curve.length()) + "] mm, got " + number_text(member.coordinate));
  if (!member.shift.isZero() && !weave.lattice) faults.add(place(crossing, index) + "/shift", "needs a lattice");
  if (!(member.backward >= 0 && member.forward >= 0))
    faults.add(place(crossing, index), "slides by ranges that must not be negative");
}

/// Adds a fault for crossings at the same place of one strand.
void check_places(const Weave& weave, const Execution& execution, Faults& faults) {
  struct Member {
    double coordinate;
    std::size_t crossing, member;
    bool operator<(const Member& other) const {
      return std::tie(coordinate, crossing, member) < std::tie(other.coordinate, other.crossing, other.member);
    }
  };
  std::vector<std::vector<Member>> on(weave.strands.size());
  for (std::size_t c = 0; c < weave.crossings.size(); ++c)
    for (std::size_t m = 0; m < weave.crossings[c].members.size(); ++m) {
      const CrossingMember& member = weave.crossings[c].members[m];
      on[static_cast<std::size_t>(member.strand)].push_back({member.coordinate, c, m});
    }
  for (std::size_t s = 0; s < on.size(); ++s) {
    execution.cancellation.throw_if_requested();
    std::sort(on[s].begin(), on[s].end());
    const StrandCurve& curve = weave.strands[s].curve;
    const double min_distance = same_coordinate * curve.length();
    const auto add_fault = [&](const Member& here, const Member& there) {
      faults.add(place(here.crossing, here.member),
                 "lies where " + place(there.crossing, there.member) + " lies on strand " + std::to_string(s));
    };
    for (std::size_t i = 1; i < on[s].size(); ++i)
      if (!(on[s][i].coordinate - on[s][i - 1].coordinate > min_distance)) add_fault(on[s][i], on[s][i - 1]);
    if (curve.ends() != Ends::open && on[s].size() > 1 &&
        !(on[s].front().coordinate + curve.length() - on[s].back().coordinate > min_distance))
      add_fault(on[s].back(), on[s].front());
  }
}

}  // namespace

Stiffness circular(double radius, const Material& material) {
  const double r2 = radius * radius;
  const double e = material.youngs_modulus;
  const double pi = std::numbers::pi;
  return {e * pi * r2, e * pi * r2 * r2 / 4, e / (2 * (1 + material.poisson_ratio)) * pi * r2 * r2 / 2};
}

Eigen::Vector2d rest_position(const Weave& weave, const CrossingMember& member) {
  Eigen::Vector2d position =
      weave.strands[static_cast<std::size_t>(member.strand)].curve.at(member.coordinate).position;
  if (weave.lattice) position += *weave.lattice * member.shift.cast<double>();
  return position;
}

void validate(const Weave& weave, const Execution& execution) {
  Faults faults;
  const Material& material = weave.material;
  faults.require(material.youngs_modulus > 0 && std::isfinite(material.youngs_modulus), "material/youngs_modulus",
                 "must be positive and finite, in MPa");
  faults.require(material.poisson_ratio > -1 && material.poisson_ratio <= 0.5, "material/poisson_ratio",
                 "must lie within (-1, 0.5]");
  faults.require(!weave.strands.empty(), "strands", "must not be empty");
  if (weave.lattice)
    faults.require(weave.lattice->allFinite() && weave.lattice->determinant() > 0, "lattice",
                   "must be finite and of positive determinant");
  for (std::size_t s = 0; s < weave.strands.size(); ++s) {
    const Strand& strand = weave.strands[s];
    const std::string where = "strands/" + std::to_string(s);
    faults.require(strand.radius > 0 && std::isfinite(strand.radius), where + "/radius", "must be positive, in mm");
    if (strand.curve.ends() != Ends::periodic) continue;
    faults.require(weave.lattice.has_value(), where, "is periodic and needs a lattice");
    if (!weave.lattice) continue;
    const Eigen::Vector2d cells = weave.lattice->inverse() * strand.curve.translation();
    faults.require((cells - cells.array().round().matrix()).norm() < same_position, where + "/translation",
                   "must be a whole number of the lattice's translations");
  }
  const double max_distance = same_position * extent(weave);
  for (std::size_t c = 0; c < weave.crossings.size(); ++c) {
    if (c % crossings_between_checks == 0) execution.cancellation.throw_if_requested();
    const auto& members = weave.crossings[c].members;
    if (members.size() < 2) faults.add("crossings/" + std::to_string(c), "must have at least two members");
    for (std::size_t m = 0; m < members.size(); ++m) check_member(weave, members[m], c, m, faults);
    if (faults.any() || members.empty()) continue;
    const Eigen::Vector2d first = rest_position(weave, members.front());
    for (std::size_t m = 1; m < members.size(); ++m)
      if (!((rest_position(weave, members[m]) - first).norm() <= max_distance))
        faults.add(place(c, m), "does not meet the crossing's first member");
  }
  if (!faults.any()) check_places(weave, execution, faults);
  faults.throw_if_any<WeaveError>("weave.invalid_layout");
}

}  // namespace supple::weave
