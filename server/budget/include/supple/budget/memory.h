#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace supple::budget {

/// Memory that this process uses, in bytes.
struct MemoryUse {
  std::int64_t resident = 0;      ///< part in main memory
  std::int64_t virtual_size = 0;  ///< address space
};

/// Reads /proc/self/statm, which takes a few microseconds. Returns zeros if it cannot be read.
MemoryUse memory_use();

/// Memory that this process may use, in bytes.
struct MemoryLimits {
  std::int64_t resident = 0;      ///< the machine's memory or the limit of the control group, whichever is less
  std::int64_t virtual_size = 0;  ///< limit of the address space (RLIMIT_AS); 0: none
};
/// Reads the limits of the machine, of the control groups (version 2 or 1) and of the process.
MemoryLimits memory_limits();

/// Default values of the server's memory settings, in bytes. They are fractions of the lower of the MemoryLimits.
struct MemoryDefaults {
  std::int64_t requests = 0;  ///< all requests and computations: half
  std::int64_t request = 0;   ///< one request: a quarter, at least 1 GiB
  std::int64_t meshes = 0;    ///< meshes that stay loaded: an eighth, at most 2 GiB
  std::int64_t helper = 0;    ///< one helper process: a quarter, at most 8 GiB
  std::int64_t process = 0;   ///< the whole server without its helpers: 11/16
};
MemoryDefaults memory_defaults(const MemoryLimits& limits);

/// Limits the C library to two arenas for each core, because each arena retains memory that was freed in it and takes
/// 64 MiB of address space. Call it before threads start.
void limit_arenas(int cores);

class ComputationMemory;

/// Limits the bytes that requests reserve before they allocate them and that computations allocate, in total and for
/// each request. Any thread may call.
class MemoryBudget {
 public:
  /// Limits in bytes: `total` for all requests together (setting --memory), `max_per_request` for one request (setting
  /// --max-request-memory), and `max_resident` for the whole process in main memory, counted or not (0: no limit).
  MemoryBudget(std::int64_t total, std::int64_t max_per_request, std::int64_t max_resident = 0)
      : total_(total), max_per_request_(max_per_request), max_resident_(max_resident) {}

  /// The bytes that one request has reserved; the destructor releases them. One thread at a time may use it.
  class Reservation {
   public:
    Reservation() = default;
    explicit Reservation(MemoryBudget& budget) : budget_(&budget) {}
    ~Reservation() { release(); }
    Reservation(Reservation&& other) noexcept;
    Reservation& operator=(Reservation&& other) noexcept;

    /// Reserves `bytes` more for `what` ("the body"). Throws ProblemError "request.too_much_memory" (413) beyond the
    /// limit of one request, and "server.out_of_memory" (503) beyond the limit of all requests or of the process, and
    /// reserves nothing then. Without a budget it does nothing.
    void add(std::int64_t bytes, const std::string& what);
    void release() noexcept;
    std::int64_t bytes() const { return bytes_; }

   private:
    MemoryBudget* budget_ = nullptr;
    std::int64_t bytes_ = 0;
  };

  std::int64_t total() const { return total_; }
  std::int64_t max_per_request() const { return max_per_request_; }
  /// Throws "request.too_much_memory" if `bytes` exceeds the limit of one request. Reserves nothing.
  void check_one(std::int64_t bytes, const std::string& what) const;
  /// Bytes that requests have reserved and computations have allocated.
  std::int64_t used() const;
  /// Stops the largest computation if the process exceeds its limit of main memory even after returning free memory.
  /// That limit includes free blocks and blocks that no computation has allocated, which no other limit counts. A
  /// watchdog calls this every few tens of milliseconds.
  void relieve();
  /// Returns free memory to the system if a large request or computation has ended since the last call and none runs. A
  /// background thread calls this: memory that is returned after every request has to be fetched by the next one.
  void return_what_is_free();

 private:
  friend class ComputationMemory;
  /// Bytes that are reserved or allocated. The caller holds the mutex.
  std::int64_t in_use() const noexcept { return reserved_ + allocated_; }
  /// Resident bytes of the process if they exceed the limit even after free memory has been returned, otherwise 0.
  std::int64_t resident_beyond_limit() const;
  /// Notes that `bytes` have been freed, which the C library may retain. The caller holds the mutex.
  void note_release(std::int64_t bytes) noexcept;

  const std::int64_t total_;
  const std::int64_t max_per_request_;
  const std::int64_t max_resident_;
  mutable std::mutex mutex_;
  std::int64_t reserved_ = 0;
  std::int64_t allocated_ = 0;
  std::vector<ComputationMemory*> computations_;
  bool may_trim_ = false;  ///< whether a large block has been freed since memory was last returned
};

/// During its lifetime, `reserve` adds to the given reservation on this thread.
class RequestMemory {
 public:
  explicit RequestMemory(MemoryBudget::Reservation& reservation);
  ~RequestMemory();
  RequestMemory(const RequestMemory&) = delete;
  RequestMemory& operator=(const RequestMemory&) = delete;

 private:
  MemoryBudget::Reservation* outer_;
};

/// Adds to the reservation of the request that this thread answers. Does nothing if it answers none. Throws what
/// Reservation::add throws.
void reserve(std::int64_t bytes, const std::string& what);

/// Returns free memory of the process to the system, which takes milliseconds.
void return_free_memory();

}  // namespace supple::budget
