#pragma once

#include <algorithm>
#include <condition_variable>
#include <list>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "supple/base/cancellation.h"

namespace supple::jobs {

/// Bounds how many immediate computations run at the same time. Of those that wait, the first one of the client with
/// the fewest that run is next: one that sends many does not keep the slots from others. Computations that do not stop
/// keep none either, up to as many as there are slots: then no thread more is taken by what nobody waits for.
class ComputeSlots {
 public:
  explicit ComputeSlots(int count) : count_(count) {}

  /// Holds a slot for its lifetime.
  class Slot {
   public:
    /// Waits for a slot. Throws what the token throws if a stop is requested meanwhile. Clients that are not told apart
    /// have the name "".
    Slot(ComputeSlots& slots, const CancellationToken& token, std::string client = {})
        : slots_(slots), client_(std::move(client)) {
      slots_.acquire(token, client_);
    }
    ~Slot() { slots_.release(client_, overdue_); }
    Slot(const Slot&) = delete;
    Slot& operator=(const Slot&) = delete;

    /// Its computation does not stop: another one may run in its place, unless that is so of too many. From any thread
    /// while the slot is there, once.
    void give_up() {
      overdue_ = true;
      slots_.give_up_one();
    }

   private:
    bool overdue_ = false;
    ComputeSlots& slots_;
    const std::string client_;
  };

  /// Computations that run or wait, those that do not stop included.
  int in_use() const;

 private:
  void acquire(const CancellationToken& token, const std::string& client);
  void release(const std::string& client, bool overdue);
  void give_up_one();
  /// Under the mutex.
  int free() const { return count_ + std::min(overdue_, count_) - running_; }
  /// Under the mutex: whose turn it is; the end where nobody waits.
  std::list<std::string>::const_iterator next() const;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::list<std::string> waiting_;  // clients in the order of arrival
  std::map<std::string, int> running_of_;
  const int count_;
  int running_ = 0;
  int overdue_ = 0;  // of those that run
};

}  // namespace supple::jobs
