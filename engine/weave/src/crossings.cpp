#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "curve_meetings.h"
#include "piece_tree.h"
#include "supple/base/error.h"
#include "supple/weave/weave.h"

namespace supple::weave {
namespace {

/// Members of one crossing lie this close together on a strand, relative to the strand's length.
constexpr double joined_coordinate = 1e-7;

/// Neighbouring pieces of a strand whose neighbours are looked for together.
constexpr std::size_t pieces_of_a_query = 16;

[[noreturn]] void refuse_layout(const std::string& what, std::size_t limit) {
  const std::string message = what + ": the limit is " + std::to_string(limit);
  throw Error("weave.invalid_layout", "The strands " + message + ".", {{"strands", message}});
}

/// Cells whose copies of the one strand can reach the other: those within the strands' extents.
int reach(const std::vector<Strand>& strands, const Eigen::Matrix2d& lattice) {
  double extent = 0;
  for (const Strand& strand : strands) extent = std::max(extent, strand.curve.length());
  const double height = lattice.determinant() / std::max(lattice.col(0).norm(), lattice.col(1).norm());
  return static_cast<int>(std::min(8.0, std::ceil(extent / height))) + 1;
}

/// A copy of the layout, moved.
struct Copy {
  Eigen::Vector2i shift;
  Eigen::Vector2d moved;

  /// A strand meets its own copies, each pair once.
  bool after() const { return shift[0] > 0 || (shift[0] == 0 && shift[1] > 0); }
};

std::vector<Copy> copies_of(const std::vector<Strand>& strands, const std::optional<Eigen::Matrix2d>& lattice) {
  if (!lattice) return {{Eigen::Vector2i::Zero(), Eigen::Vector2d::Zero()}};
  const int cells = reach(strands, *lattice);
  std::vector<Copy> copies;
  for (int i = -cells; i <= cells; ++i)
    for (int j = -cells; j <= cells; ++j) {
      const Eigen::Vector2i shift(i, j);
      copies.push_back({shift, *lattice * shift.cast<double>()});
    }
  return copies;
}

struct Meeting {
  CrossingMember first;
  CrossingMember second;
};

/// Finds the meetings of one strand after the other with those that follow it, and with all copies of either.
class MeetingSearch {
 public:
  MeetingSearch(const std::vector<Strand>& strands, const std::optional<Eigen::Matrix2d>& lattice,
                const Execution& execution)
      : strands_(strands), execution_(execution), copies_(copies_of(strands, lattice)), tree_(strands, execution) {}

  /// By the second strand, its shift and the coordinate on the first.
  std::vector<Meeting> of(std::int32_t strand) {
    const StrandCurve& curve = strands_[static_cast<std::size_t>(strand)].curve;
    const std::vector<Eigen::AlignedBox2d> boxes = piece_boxes(curve);
    const std::vector<std::size_t> reached = copies_near(boxes);
    std::map<std::pair<std::int32_t, std::size_t>, CurveMeetings> meetings;
    for (std::size_t first = 0; first < boxes.size(); first += pieces_of_a_query) {
      const std::size_t end = std::min(boxes.size(), first + pieces_of_a_query);
      find_near(boxes, first, end, strand, reached);
      for (std::size_t piece = first; piece < end; ++piece) {
        execution_.cancellation.throw_if_requested();
        for (const Near& near : near_) {
          if (!boxes[piece].intersects(near.box)) continue;
          execution_.cancellation.throw_if_requested();
          if (++compared_ > most_near_pieces) refuse_near_pieces();
          auto& group =
              meetings
                  .try_emplace({near.strand, near.copy}, curve, strands_[static_cast<std::size_t>(near.strand)].curve,
                               copies_[near.copy].moved)
                  .first->second;
          found_ += group.add_pieces(piece, static_cast<std::size_t>(near.piece));
          if (found_ > most_crossings) refuse_layout("cross at too many places", most_crossings);
        }
      }
    }
    std::vector<Meeting> result;
    for (auto& [key, group] : meetings)
      for (const Intersection& at : group.take_sorted())
        result.push_back({{strand, at.first}, {key.first, at.second, copies_[key.second].shift}});
    return result;
  }

 private:
  /// Copies of the whole layout that the strand reaches.
  std::vector<std::size_t> copies_near(const std::vector<Eigen::AlignedBox2d>& boxes) const {
    Eigen::AlignedBox2d around;
    for (const Eigen::AlignedBox2d& box : boxes) around.extend(box);
    std::vector<std::size_t> result;
    for (std::size_t k = 0; k < copies_.size(); ++k)
      if (around.intersects(tree_.box().translated(copies_[k].moved))) result.push_back(k);
    return result;
  }

  /// A piece of another strand, or of another copy, near some pieces of a strand.
  struct Near {
    std::int32_t strand, piece;
    std::size_t copy;
    Eigen::AlignedBox2d box;
  };

  [[noreturn]] static void refuse_near_pieces() {
    refuse_layout("have too many pairs of pieces that lie near each other", most_near_pieces);
  }

  /// By strands, copies and pieces. Neighbouring pieces are asked for together: they have nearly the same neighbours.
  void find_near(const std::vector<Eigen::AlignedBox2d>& boxes, std::size_t first, std::size_t end, std::int32_t strand,
                 const std::vector<std::size_t>& reached) {
    Eigen::AlignedBox2d around;
    for (std::size_t piece = first; piece < end; ++piece) around.extend(boxes[piece]);
    near_.clear();
    for (const std::size_t copy : reached) {
      execution_.cancellation.throw_if_requested();
      const bool own_copy = copies_[copy].after();
      tree_.for_each_near(around, copies_[copy].moved, own_copy ? strand : strand + 1,
                          [&](std::int32_t other, std::int32_t piece, const Eigen::AlignedBox2d& box) {
                            near_.push_back({other, piece, copy, box});
                          });
    }
    if (near_.size() > most_near_pieces) refuse_near_pieces();
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

/// Makes crossings of meetings: a third strand through the same point joins the crossing that the first two made.
class CrossingAssembly {
 public:
  explicit CrossingAssembly(const std::vector<Strand>& strands) : strands_(strands), members_(strands.size()) {}

  void add(const Meeting& meeting) {
    const auto known = find(meeting.first);
    if (!known) {
      add_member(crossings_.size(), 0, meeting.first);
      add_member(crossings_.size(), 1, meeting.second);
      crossings_.push_back({{meeting.first, meeting.second}});
      return;
    }
    auto& members = crossings_[known->crossing].members;
    CrossingMember joined = meeting.second;
    joined.shift += members[known->member].shift;
    if (has(known->crossing, joined)) return;
    add_member(known->crossing, members.size(), joined);
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

  /// Calls visit(place) for the members that lie where `where` lies on its strand.
  template <class Visit>
  void for_each_at(const CrossingMember& where, const Visit& visit) const {
    const auto s = static_cast<std::size_t>(where.strand);
    const double near = joined_coordinate * strands_[s].curve.length();
    // A little farther, for the comparison to decide.
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
  MeetingSearch search(strands, lattice, execution);
  CrossingAssembly assembly(strands);
  for (std::size_t s = 0; s < strands.size(); ++s) {
    execution.checkpoint(static_cast<double>(s) / static_cast<double>(strands.size()), "crossings");
    for (const Meeting& meeting : search.of(static_cast<std::int32_t>(s))) {
      execution.cancellation.throw_if_requested();
      assembly.add(meeting);
    }
  }
  return assembly.take();
}

}  // namespace supple::weave
