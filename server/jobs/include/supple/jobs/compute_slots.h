#pragma once

#include <condition_variable>
#include <list>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "supple/base/cancellation.h"

namespace supple::jobs {

/// Bounds how many immediate computations run at the same time. Of those that wait, the first one of the client with
/// the fewest that run is next: one that sends many does not keep the slots from others.
class ComputeSlots {
 public:
  explicit ComputeSlots(int count) : free_(count) {}

  /// Holds a slot for its lifetime.
  class Slot {
   public:
    /// Waits for a slot. Throws what the token throws if a stop is requested meanwhile. Clients that are not told apart
    /// have the name "".
    Slot(ComputeSlots& slots, const CancellationToken& token, std::string client = {})
        : slots_(slots), client_(std::move(client)) {
      slots_.acquire(token, client_);
    }
    ~Slot() { slots_.release(client_); }
    Slot(const Slot&) = delete;
    Slot& operator=(const Slot&) = delete;

   private:
    ComputeSlots& slots_;
    const std::string client_;
  };

  /// Computations that run or wait.
  int in_use() const;

 private:
  void acquire(const CancellationToken& token, const std::string& client);
  void release(const std::string& client);
  /// Under the mutex: whose turn it is; the end where nobody waits.
  std::list<std::string>::const_iterator next() const;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::list<std::string> waiting_;  // clients in the order of arrival
  std::map<std::string, int> running_of_;
  int free_;
  int running_ = 0;
};

}  // namespace supple::jobs
