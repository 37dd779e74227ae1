#include "supple/weave/weave.h"
#include "supple/base/faults.h"

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
/// Two crossings of one strand are this far apart at least, relative to the strand's length.
constexpr double same_coordinate = 1e-7;

double extent(const Weave& weave) {
  Eigen::AlignedBox2d box;
  for (const Strand& strand : weave.strands)
    for (const double s : strand.curve.point_coordinates()) box.extend(strand.curve.at(s).position);
  return std::max(box.isEmpty() ? 0.0 : box.diagonal().norm(), 1e-9);
}

std::string place(std::size_t crossing, std::size_t member) {
  return "crossings/" + std::to_string(crossing) + "/members/" + std::to_string(member);
}

void check_member(const Weave& weave, const CrossingMember& member, const std::string& where, Faults& faults) {
  const bool known = member.strand >= 0 && member.strand < static_cast<int>(weave.strands.size());
  faults.require(known, where + "/strand", "names no strand");
  if (!known) return;
  const StrandCurve& curve = weave.strands[static_cast<std::size_t>(member.strand)].curve;
  faults.require(
      member.coordinate >= 0 && member.coordinate <= curve.length(), where + "/coordinate",
      "must lie within [0, " + std::to_string(curve.length()) + "] mm, got " + std::to_string(member.coordinate));
  faults.require(member.shift.isZero() || weave.lattice.has_value(), where + "/shift", "needs a lattice");
  faults.require(member.backward >= 0 && member.forward >= 0, where, "slides by ranges that must not be negative");
}

/// Crossings at one place of one strand.
void check_places(const Weave& weave, Faults& faults) {
  std::vector<std::vector<std::pair<double, std::string>>> on(weave.strands.size());
  for (std::size_t c = 0; c < weave.crossings.size(); ++c)
    for (std::size_t m = 0; m < weave.crossings[c].members.size(); ++m) {
      const CrossingMember& member = weave.crossings[c].members[m];
      on[static_cast<std::size_t>(member.strand)].emplace_back(member.coordinate, place(c, m));
    }
  for (std::size_t s = 0; s < on.size(); ++s) {
    std::sort(on[s].begin(), on[s].end());
    const StrandCurve& curve = weave.strands[s].curve;
    const double least = same_coordinate * curve.length();
    for (std::size_t i = 1; i < on[s].size(); ++i)
      faults.require(on[s][i].first - on[s][i - 1].first > least, on[s][i].second,
                     "lies where " + on[s][i - 1].second + " lies on strand " + std::to_string(s));
    if (curve.ends() != Ends::open && on[s].size() > 1)
      faults.require(on[s].front().first + curve.length() - on[s].back().first > least, on[s].back().second,
                     "lies where " + on[s].front().second + " lies on strand " + std::to_string(s));
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

void validate(const Weave& weave) {
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
  const double apart = same_position * extent(weave);
  for (std::size_t c = 0; c < weave.crossings.size(); ++c) {
    const auto& members = weave.crossings[c].members;
    const std::string where = "crossings/" + std::to_string(c);
    faults.require(members.size() >= 2, where, "must have at least two members");
    for (std::size_t m = 0; m < members.size(); ++m) check_member(weave, members[m], place(c, m), faults);
    if (faults.any() || members.empty()) continue;
    const Eigen::Vector2d first = rest_position(weave, members.front());
    for (std::size_t m = 1; m < members.size(); ++m)
      faults.require((rest_position(weave, members[m]) - first).norm() <= apart, place(c, m),
                     "does not meet the crossing's first member");
  }
  if (!faults.any()) check_places(weave, faults);
  faults.throw_if_any("weave.invalid_layout");
}

namespace {

struct Meeting {
  CrossingMember first;
  CrossingMember second;
};

/// Cells whose copies of the one strand can reach the other: those within the strands' extents.
int reach(const std::vector<Strand>& strands, const Eigen::Matrix2d& lattice) {
  double extent = 0;
  for (const Strand& strand : strands) extent = std::max(extent, strand.curve.length());
  const double height = lattice.determinant() / std::max(lattice.col(0).norm(), lattice.col(1).norm());
  return static_cast<int>(std::min(8.0, std::ceil(extent / height))) + 1;
}

/// Boxes that contain the strands: most pairs need no closer look.
std::vector<Eigen::AlignedBox2d> boxes_of(const std::vector<Strand>& strands) {
  std::vector<Eigen::AlignedBox2d> boxes;
  boxes.reserve(strands.size());
  for (const Strand& strand : strands) {
    const std::vector<double>& knots = strand.curve.knots();
    Eigen::AlignedBox2d box;
    double longest = 0;
    for (std::size_t i = 0; i < knots.size(); ++i) {
      // Periodic curves begin anew at their length: their last point is the first one's copy.
      box.extend(i + 1 < knots.size() || strand.curve.ends() == Ends::open
                     ? strand.curve.at(knots[i]).position
                     : Eigen::Vector2d(strand.curve.at(0).position + strand.curve.translation()));
      if (i > 0) longest = std::max(longest, knots[i] - knots[i - 1]);
    }
    // Between its knots a curve leaves their chord by a small part of it.
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant((strand.curve.straight() ? 1e-6 : 0.1) * longest);
    boxes.emplace_back(box.min() - margin, box.max() + margin);
  }
  return boxes;
}

/// Strands whose boxes meet: `second`'s moved by lattice * shift.
struct Pair {
  int first = 0;
  int second = 0;
  Eigen::Vector2i shift{0, 0};
};

/// Pairs that are kept: beyond, crossings would not fit into memory.
constexpr std::size_t most_pairs = 2'000'000;

/// All pairs, by strands and shifts. Boxes are swept along x: of strands that are short against the layout only
/// neighbours are looked at.
std::vector<Pair> near_pairs(const std::vector<Strand>& strands, const std::optional<Eigen::Matrix2d>& lattice) {
  const std::vector<Eigen::AlignedBox2d> boxes = boxes_of(strands);
  std::vector<std::pair<double, int>> begins;
  begins.reserve(boxes.size());
  double widest = 0;
  for (std::size_t s = 0; s < boxes.size(); ++s) {
    begins.emplace_back(boxes[s].min()[0], static_cast<int>(s));
    widest = std::max(widest, boxes[s].sizes()[0]);
  }
  std::sort(begins.begin(), begins.end());
  const int cells = lattice ? reach(strands, *lattice) : 0;
  std::vector<Pair> pairs;
  for (int i = -cells; i <= cells; ++i) {
    for (int j = -cells; j <= cells; ++j) {
      const Eigen::Vector2i shift(i, j);
      const Eigen::Vector2d moved =
          lattice ? Eigen::Vector2d(*lattice * shift.cast<double>()) : Eigen::Vector2d::Zero();
      for (int a = 0; a < static_cast<int>(boxes.size()); ++a) {
        const Eigen::AlignedBox2d& box = boxes[static_cast<std::size_t>(a)];
        auto next = std::lower_bound(begins.begin(), begins.end(), std::pair(box.min()[0] - moved[0] - widest, -1));
        for (; next != begins.end() && next->first + moved[0] <= box.max()[0]; ++next) {
          const int b = next->second;
          // A strand meets its own copies, each pair once.
          if (b < a || (a == b && (i < 0 || (i == 0 && j <= 0)))) continue;
          if (!box.intersects(boxes[static_cast<std::size_t>(b)].translated(moved))) continue;
          if (pairs.size() == most_pairs)
            throw Error("weave.invalid_layout", "More than 2 million pairs of strands may cross.",
                        {{"strands", "are too many: more than 2 million pairs of them may cross"}});
          pairs.push_back({a, b, shift});
        }
      }
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) {
    return std::tuple(p.first, p.second, p.shift[0], p.shift[1]) <
           std::tuple(q.first, q.second, q.shift[0], q.shift[1]);
  });
  return pairs;
}

std::vector<Meeting> meetings(const std::vector<Strand>& strands, const std::optional<Eigen::Matrix2d>& lattice) {
  std::vector<Meeting> found;
  for (const Pair& pair : near_pairs(strands, lattice)) {
    const Eigen::Vector2d moved =
        lattice ? Eigen::Vector2d(*lattice * pair.shift.cast<double>()) : Eigen::Vector2d::Zero();
    for (const Intersection& at : intersections(strands[static_cast<std::size_t>(pair.first)].curve,
                                                strands[static_cast<std::size_t>(pair.second)].curve, moved))
      found.push_back({{pair.first, at.first}, {pair.second, at.second, pair.shift}});
  }
  return found;
}

}  // namespace

std::vector<Crossing> find_crossings(const std::vector<Strand>& strands,
                                     const std::optional<Eigen::Matrix2d>& lattice) {
  std::vector<Crossing> crossings;
  std::vector<std::vector<std::size_t>> on_strand(strands.size());
  const auto same = [&](const CrossingMember& a, const CrossingMember& b) {
    return a.strand == b.strand && std::abs(a.coordinate - b.coordinate) <=
                                       same_coordinate * strands[static_cast<std::size_t>(a.strand)].curve.length();
  };
  for (const Meeting& meeting : meetings(strands, lattice)) {
    const auto is_first = [&](const CrossingMember& m) { return same(m, meeting.first); };
    // A third strand through the same point joins the crossing that the first two made.
    auto& of_first = on_strand[static_cast<std::size_t>(meeting.first.strand)];
    auto& of_second = on_strand[static_cast<std::size_t>(meeting.second.strand)];
    const auto known = std::find_if(of_first.begin(), of_first.end(), [&](std::size_t c) {
      return std::any_of(crossings[c].members.begin(), crossings[c].members.end(), is_first);
    });
    if (known == of_first.end()) {
      of_first.push_back(crossings.size());
      if (meeting.second.strand != meeting.first.strand) of_second.push_back(crossings.size());
      crossings.push_back({{meeting.first, meeting.second}});
      continue;
    }
    auto& members = crossings[*known].members;
    CrossingMember joined = meeting.second;
    joined.shift += std::find_if(members.begin(), members.end(), is_first)->shift;
    const bool present = std::any_of(members.begin(), members.end(), [&](const CrossingMember& m) {
      return same(m, joined) && m.shift == joined.shift;
    });
    if (present) continue;
    of_second.push_back(*known);
    members.push_back(joined);
  }
  return crossings;
}

}  // namespace supple::weave
