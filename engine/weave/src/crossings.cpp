#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "curve_intersections.h"
#include "piece_tree.h"
#include "supple/weave/weave.h"
#include "supple/weave/weave_error.h"

namespace supple::weave {
namespace {

/// Members of one crossing lie this close together on a strand, relative to the strand's length.
constexpr double same_member_tolerance = 1e-7;

/// Number of consecutive pieces of a strand that share one search for pieces near them.
constexpr std::size_t pieces_per_query = 16;

[[noreturn]] void refuse_layout(const std::string& what, std::size_t limit) {
  const std::string message = what + ": the limit is " + std::to_string(limit);
  throw WeaveError("weave.invalid_layout", "The strands " + message + ".", {{"strands", message}});
}

/// Number of cells in each lattice direction, as far as the strands extend, whose copies of one strand can reach
/// another strand.
int cells_in_reach(const std::vector<Strand>& strands, const Eigen::Matrix2d& lattice) {
  double extent = 0;
  for (const Strand& strand : strands) extent = std::max(extent, strand.curve.length());
  const double height = lattice.determinant() / std::max(lattice.col(0).norm(), lattice.col(1).norm());
  return static_cast<int>(std::min(8.0, std::ceil(extent / height))) + 1;
}

/// A copy of the layout in another cell.
struct Copy {
  Eigen::Vector2i shift;
  Eigen::Vector2d translation;

  /// True for one of a copy and its opposite. Selects the copies with which a strand itself is compared, so that each
  /// pair counts once.
  bool is_positive() const { return shift[0] > 0 || (shift[0] == 0 && shift[1] > 0); }
};

std::vector<Copy> copies_of(const std::vector<Strand>& strands, const std::optional<Eigen::Matrix2d>& lattice) {
  if (!lattice) return {{Eigen::Vector2i::Zero(), Eigen::Vector2d::Zero()}};
  const int cells = cells_in_reach(strands, *lattice);
  std::vector<Copy> copies;
  for (int i = -cells; i <= cells; ++i)
    for (int j = -cells; j <= cells; ++j) {
      const Eigen::Vector2i shift(i, j);
      copies.push_back({shift, *lattice * shift.cast<double>()});
    }
  return copies;
}

struct StrandIntersection {
  CrossingMember first;
  CrossingMember second;
};

/// Finds the intersections of each strand with the strands that follow it, and with the copies of both.
class IntersectionSearch {
 public:
  IntersectionSearch(const std::vector<Strand>& strands, const std::optional<Eigen::Matrix2d>& lattice,
                     const Execution& execution)
      : strands_(strands), execution_(execution), copies_(copies_of(strands, lattice)), tree_(strands, execution) {}

  /// The intersections of a strand, sorted by the second strand, its shift and the coordinate on the first strand.
  std::vector<StrandIntersection> of(std::int32_t strand) {
    const StrandCurve& curve = strands_[static_cast<std::size_t>(strand)].curve;
    const std::vector<Eigen::AlignedBox2d> boxes = piece_boxes(curve);
    const std::vector<std::size_t> reached_copies = copies_near(boxes);
    std::map<std::pair<std::int32_t, std::size_t>, CurveIntersections> by_copy;
    for (std::size_t first = 0; first < boxes.size(); first += pieces_per_query) {
      const std::size_t end = std::min(boxes.size(), first + pieces_per_query);
      find_near(boxes, first, end, strand, reached_copies);
      for (std::size_t piece = first; piece < end; ++piece) {
        execution_.cancellation.throw_if_requested();
        for (const Near& near : near_) {
          if (!boxes[piece].intersects(near.box)) continue;
          execution_.cancellation.throw_if_requested();
          if (++compared_ > max_near_pairs) refuse_near_pieces();
          auto& group =
              by_copy
                  .try_emplace({near.strand, near.copy}, curve, strands_[static_cast<std::size_t>(near.strand)].curve,
                               copies_[near.copy].translation)
                  .first->second;
          found_ += group.add_pieces(piece, static_cast<std::size_t>(near.piece));
          if (found_ > max_crossings) refuse_layout("cross at too many places", max_crossings);
        }
      }
    }
    std::vector<StrandIntersection> result;
    for (auto& [key, group] : by_copy)
      for (const Intersection& at : group.take_sorted())
        result.push_back({{strand, at.first}, {key.first, at.second, copies_[key.second].shift}});
    return result;
  }

 private:
  /// Indices of the copies of the layout whose bounding box the strand reaches.
  std::vector<std::size_t> copies_near(const std::vector<Eigen::AlignedBox2d>& boxes) const {
    Eigen::AlignedBox2d around;
    for (const Eigen::AlignedBox2d& box : boxes) around.extend(box);
    std::vector<std::size_t> result;
    for (std::size_t k = 0; k < copies_.size(); ++k)
      if (around.intersects(tree_.box().translated(copies_[k].translation))) result.push_back(k);
    return result;
  }

  /// A piece of another strand, or of another copy, near some pieces of a strand.
  struct Near {
    std::int32_t strand, piece;
    std::size_t copy;
    Eigen::AlignedBox2d box;
  };

  [[noreturn]] static void refuse_near_pieces() {
    refuse_layout("have too many pairs of pieces that lie near each other", max_near_pairs);
  }

  /// Finds the pieces near the pieces [first, end) of a strand, sorted by strands, copies and pieces. Neighbouring
  /// pieces share one search, since they have nearly the same neighbours.
  void find_near(const std::vector<Eigen::AlignedBox2d>& boxes, std::size_t first, std::size_t end, std::int32_t strand,
                 const std::vector<std::size_t>& reached_copies) {
    Eigen::AlignedBox2d around;
    for (std::size_t piece = first; piece < end; ++piece) around.extend(boxes[piece]);
    near_.clear();
    for (const std::size_t copy : reached_copies) {
      execution_.cancellation.throw_if_requested();
      const bool own_copy = copies_[copy].is_positive();
      tree_.for_each_near(around, copies_[copy].translation, own_copy ? strand : strand + 1,
                          [&](std::int32_t other, std::int32_t piece, const Eigen::AlignedBox2d& box) {
                            near_.push_back({other, piece, copy, box});
                          });
    }
    if (near_.size() > max_near_pairs) refuse_near_pieces();
    std::sort(near_.begin(), near_.end(), [](const Near& a, const Near& b) {
      return std::tie(a.strand, a.copy, a.piece) < std::tie(b.strand, b.copy, b.piece);
    });
  }

  const std::vector<Strand>& strands_;
  const Execution& execution_;
  std::vector<Copy> copies_;
  PieceTree tree_;
  std::vector<Near> near_;
  std::size_t compared_ = 0;
  std::size_t found_ = 0;
};

/// Makes crossings from intersections. A third strand through the same point joins the crossing that the first two
/// made.
class CrossingAssembly {
 public:
  explicit CrossingAssembly(const std::vector<Strand>& strands) : strands_(strands), members_(strands.size()) {}

  void add(const StrandIntersection& intersection) {
    const auto existing = find(intersection.first);
    if (!existing) {
      add_member(crossings_.size(), 0, intersection.first);
      add_member(crossings_.size(), 1, intersection.second);
      crossings_.push_back({{intersection.first, intersection.second}});
      return;
    }
    auto& members = crossings_[existing->crossing].members;
    CrossingMember joined = intersection.second;
    joined.shift += members[existing->member].shift;
    if (has(existing->crossing, joined)) return;
    add_member(existing->crossing, members.size(), joined);
    members.push_back(joined);
  }

  std::vector<Crossing> take() { return std::move(crossings_); }

 private:
  struct Place {
    std::size_t crossing, member;
    bool operator<(const Place& other) const {
      return std::tie(crossing, member) < std::tie(other.crossing, other.member);
    }
  };

  void add_member(std::size_t crossing, std::size_t member, const CrossingMember& where) {
    members_[static_cast<std::size_t>(where.strand)].emplace(where.coordinate, Place{crossing, member});
  }

  /// Calls visit(place) for the members at the same point of the same strand as `where`.
  template <class Visit>
  void for_each_at(const CrossingMember& where, const Visit& visit) const {
    const auto s = static_cast<std::size_t>(where.strand);
    const double near = same_member_tolerance * strands_[s].curve.length();
    // The search range is wider than the tolerance, so that only the comparison decides.
    for (auto at = members_[s].lower_bound(where.coordinate - 2 * near);
         at != members_[s].end() && at->first <= where.coordinate + 2 * near; ++at)
      if (std::abs(at->first - where.coordinate) <= near) visit(at->second);
  }

  std::optional<Place> find(const CrossingMember& where) const {
    std::optional<Place> first;
    for_each_at(where, [&](const Place& place) {
      if (!first || place < *first) first = place;
    });
    return first;
  }

  bool has(std::size_t crossing, const CrossingMember& wanted) const {
    bool found = false;
    for_each_at(wanted, [&](const Place& place) {
      found = found || (place.crossing == crossing && crossings_[crossing].members[place.member].shift == wanted.shift);
    });
    return found;
  }

  const std::vector<Strand>& strands_;
  std::vector<Crossing> crossings_;
  std::vector<std::multimap<double, Place>> members_;  ///< of each strand, by their coordinates
};

}  // namespace

std::vector<Crossing> find_crossings(const std::vector<Strand>& strands, const std::optional<Eigen::Matrix2d>& lattice,
                                     const Execution& execution) {
  if (strands.empty()) return {};
  IntersectionSearch search(strands, lattice, execution);
  CrossingAssembly assembly(strands);
  for (std::size_t s = 0; s < strands.size(); ++s) {
    execution.checkpoint(static_cast<double>(s) / static_cast<double>(strands.size()), "crossings");
    for (const StrandIntersection& intersection : search.of(static_cast<std::int32_t>(s))) {
      execution.cancellation.throw_if_requested();
      assembly.add(intersection);
    }
  }
  return assembly.take();
}

}  // namespace supple::weave
