#pragma once

#include <algorithm>
#include <compare>
#include <map>
#include <string>
#include <utility>

#include "supple/base/priority.h"

namespace supple::jobs {

/// Whose computation is next: counts the running computations of each client, so that none keeps the places from
/// others, and says how far interactive computations go before the others. Computations in the background have places
/// of their own and do not count for the turns of the others. Whoever owns it guards it.
class ClientTurns {
 public:
  /// Interactive computations that may run in succession before one that is not interactive.
  static constexpr int max_in_succession = 4;

  /// `places`: workers, or slots.
  explicit ClientTurns(int places) : max_first_of_client_(std::max(1, places / 2)) {}

  /// The order of computations that wait: the one with the least rank is next, the first one among equals.
  struct Rank {
    /// An interactive computation goes before the others while less than half of the places, but at least one, are
    /// taken by interactive ones of its client. Beyond that it is as urgent as a normal one, and first among its like.
    Priority urgency = Priority::normal;
    int running_of_client = 0;  ///< its client's running computations that take the same places
    Priority priority = Priority::normal;

    auto operator<=>(const Rank&) const = default;
  };
  Rank rank_of(const std::string& client, Priority priority) const;
  /// Whether a computation that is not interactive has its turn.
  bool is_turn_of_others() const { return in_succession_ >= max_in_succession; }

  /// A computation begins, while others that are not interactive wait or do not.
  void begin(const std::string& client, Priority priority, bool others_wait);
  void end(const std::string& client, Priority priority);

 private:
  int running_of(const std::string& client, Priority priority) const;

  int max_first_of_client_;
  std::map<std::pair<std::string, Priority>, int> running_;  // by client and priority
  int in_succession_ = 0;
};

}  // namespace supple::jobs
