#pragma once

#include <algorithm>
#include <condition_variable>
#include <list>
#include <mutex>
#include <string>
#include <utility>

#include "client_turns.h"
#include "supple/base/cancellation.h"
#include "supple/base/priority.h"

namespace supple::jobs {

/// Limits how many immediate computations run at the same time. Among those that wait, an interactive one is next, as
/// far as ClientTurns says, then the first one of the client with the fewest running ones, so that a client that sends
/// many does not take the slots from others. Where all slots are taken, one more computation may run if it is
/// interactive and goes first. A computation that does not stop takes no slot either, as long as there are no more such
/// computations than slots; otherwise threads would be used up by computations that nobody waits for. Computations in
/// the background take no slots, but workers of their own. Any thread may call.
class ComputeSlots {
  struct Computation {
    Priority priority;
    std::string client;
  };

 public:
  explicit ComputeSlots(int count) : turns_(count), count_(count) {}

  /// Takes a slot for its lifetime.
  class Slot {
   public:
    /// Waits for a slot. Throws the error of a stop request that comes meanwhile. All clients that are not told apart
    /// have the name "".
    Slot(ComputeSlots& slots, const CancellationToken& token, std::string client = {},
         Priority priority = Priority::normal)
        : slots_(slots), taken_{priority, std::move(client)} {
      slots_.acquire(token, taken_);
    }
    ~Slot() { slots_.release(taken_, is_given_up_); }
    Slot(const Slot&) = delete;
    Slot& operator=(const Slot&) = delete;

    /// The computation does not stop: another one may run in its place, unless too many are given up. To be called once
    /// at most, from any thread.
    void give_up() {
      is_given_up_ = true;
      slots_.give_up_one();
    }

   private:
    bool is_given_up_ = false;
    ComputeSlots& slots_;
    const Computation taken_;
  };

  /// Number of computations that run or wait, with those that do not stop.
  int in_use() const;

 private:
  void acquire(const CancellationToken& token, const Computation& computation);
  void release(const Computation& computation, bool is_given_up);
  void give_up_one();
  // The caller of the following functions holds the mutex.
  int free(Priority priority) const {
    const int for_interactive = priority == Priority::interactive ? 1 : 0;
    return count_ + for_interactive + std::min(given_up_, count_) - running_;
  }
  ClientTurns::Rank rank_of(const Computation& one) const { return turns_.rank_of(one.client, one.priority); }
  /// The computation that runs next; the end where none waits.
  std::list<Computation>::const_iterator next() const;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::list<Computation> waiting_;  // the computations that wait, in the order of arrival
  ClientTurns turns_;
  const int count_;
  int running_ = 0;
  int given_up_ = 0;  // running computations whose slots are given up
};

}  // namespace supple::jobs
