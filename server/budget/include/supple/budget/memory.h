#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace supple::budget {

/// What this process has of the machine's memory, in bytes.
struct MemoryUse {
  std::int64_t resident = 0;  ///< in main memory
  std::int64_t virtual_size = 0;
};

/// Reads /proc/self/statm; a few microseconds. Zeros where it cannot be read.
MemoryUse memory_use();

/// What the process may have, in bytes: the least of the machine's memory and its control group's limit (version 2 or
/// 1), and of its address space (RLIMIT_AS); the latter 0 where there is no limit.
struct MemoryLimits {
  std::int64_t resident = 0;
  std::int64_t virtual_size = 0;
};
MemoryLimits memory_limits();

/// How a server divides the memory that it may have where nobody says otherwise, in bytes.
struct MemoryShares {
  std::int64_t requests = 0;  ///< for what requests reserve and computations allocate: half
  std::int64_t request = 0;   ///< for one of them: a quarter, but 1 GiB at least
  std::int64_t meshes = 0;    ///< for meshes that stay loaded: an eighth, 2 GiB at most
  std::int64_t helper = 0;    ///< for one helper process: a quarter, 8 GiB at most
  std::int64_t process = 0;   ///< for the whole server without its helpers: 11 parts of 16
};
MemoryShares default_shares(const MemoryLimits& limits);

/// Has the C library divide memory among few arenas: each keeps what was freed in it, and sets aside 64 MiB of address
/// space. Call before threads start.
void share_arenas(int cores);

class ComputationMemory;

/// Bytes that requests reserve before they are allocated and that computations allocate, all together and each by
/// itself. Any thread may call.
class MemoryBudget {
 public:
  /// `total` for all requests together (setting --memory), `each` for one (setting --max-request-memory); `process` for
  /// all that the process has in main memory, whoever counts it; 0: any amount.
  MemoryBudget(std::int64_t total, std::int64_t each, std::int64_t process = 0)
      : total_(total), each_(each), process_(process) {}

  /// Bytes of one request; they come back when it is destroyed. Moved, not copied; used by one thread at a time.
  class Reservation {
   public:
    Reservation() = default;
    explicit Reservation(MemoryBudget& budget) : budget_(&budget) {}
    ~Reservation() { release(); }
    Reservation(Reservation&& other) noexcept;
    Reservation& operator=(Reservation&& other) noexcept;

    /// Reserves so many bytes more for `what` ("the body"). Throws ProblemError "request.too_much_memory" (413) beyond
    /// the limit of one request, "server.out_of_memory" (503) where all requests together, or the process, have no room
    /// left; nothing is reserved then. Does nothing without a budget.
    void add(std::int64_t bytes, const std::string& what);
    void release() noexcept;
    std::int64_t bytes() const { return bytes_; }

   private:
    MemoryBudget* budget_ = nullptr;
    std::int64_t bytes_ = 0;
  };

  std::int64_t total() const { return total_; }
  std::int64_t each() const { return each_; }
  /// Throws "request.too_much_memory" where so many bytes are more than one request may have, and reserves nothing.
  void check_one(std::int64_t bytes, const std::string& what) const;
  /// What requests have reserved and computations have allocated.
  std::int64_t used() const;
  /// For a thread that looks every few tens of milliseconds: where the process has more in main memory than it may,
  /// although free memory has been given back, the computation that holds most is stopped. Blocks that are free but not
  /// returned, and those that no computation pays for, are not counted otherwise.
  void relieve();
  /// Gives memory back to the system, where a large request or computation has ended since the last call and nothing is
  /// computed. For a thread that has time for it: what is given back at once has to be fetched again by the next one.
  void return_what_is_free();

 private:
  friend class ComputationMemory;
  /// Under the mutex.
  std::int64_t in_use() const noexcept { return reserved_ + allocated_; }
  /// What the process has in main memory where that is more than it may have and nothing of it is free; otherwise 0.
  std::int64_t too_many_resident() const;
  /// Under the mutex: so many bytes have become free, which the C library may keep.
  void note_release(std::int64_t bytes) noexcept;

  const std::int64_t total_;
  const std::int64_t each_;
  const std::int64_t process_;
  mutable std::mutex mutex_;
  std::int64_t reserved_ = 0;
  std::int64_t allocated_ = 0;
  std::vector<ComputationMemory*> computations_;
  bool holds_free_memory_ = false;
};

/// Makes a reservation the one that `reserve` adds to on this thread, for its lifetime.
class RequestMemory {
 public:
  explicit RequestMemory(MemoryBudget::Reservation& reservation);
  ~RequestMemory();
  RequestMemory(const RequestMemory&) = delete;
  RequestMemory& operator=(const RequestMemory&) = delete;

 private:
  MemoryBudget::Reservation* outer_;
};

/// Adds to the reservation of the request that this thread answers; nothing where it answers none. Throws as
/// Reservation::add does.
void reserve(std::int64_t bytes, const std::string& what);

/// Gives memory that is free within the process back to the system. Takes milliseconds.
void return_free_memory();

}  // namespace supple::budget
