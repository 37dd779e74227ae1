#pragma once

#include <algorithm>

namespace supple::jobs {

/// How far interactive computations go before others, so that neither one client nor all together keep the others from
/// their turn. Whoever owns it guards it.
class InteractiveTurns {
 public:
  /// Computations that may run in succession before one that is not interactive.
  static constexpr int max_in_succession = 4;

  /// `places`: workers, or slots.
  explicit InteractiveTurns(int places) : max_of_client_(std::max(1, places / 2)) {}

  /// Whether an interactive computation goes before the others. It does while less than half of the places, but at
  /// least one, are taken by interactive ones of its client. Beyond that it is as urgent as a normal one.
  bool goes_first(int running_of_client) const { return running_of_client < max_of_client_; }
  /// Whether one that is not interactive has its turn.
  bool is_turn_of_others() const { return in_succession_ >= max_in_succession; }
  /// A computation begins, while others that are not interactive wait or do not.
  void note_start(bool is_interactive, bool others_wait) {
    in_succession_ = is_interactive && others_wait ? in_succession_ + 1 : 0;
  }

 private:
  int max_of_client_;
  int in_succession_ = 0;
};

}  // namespace supple::jobs
