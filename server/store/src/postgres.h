#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <pqxx/pqxx>
#include <string>
#include <utility>

#include "socket_deadline.h"
#include "supple/base/error.h"

namespace supple::store {

/// A connection to a PostgreSQL database, which is made again once it is lost. Any thread may call; calls take turns.
///
/// Errors throw "store.full" where the database's disk is, "store.unavailable" otherwise.
class Postgres {
 public:
  /// Nothing is connected yet. `address` is a connection string of libpq. Where it does not say how long a machine that
  /// does not answer is waited for, a connection is given up after 3 seconds, and closed by the system once nothing
  /// that was sent has been acknowledged for 5.
  /// A transaction that takes longer than `patience`, in seconds, is given up with its connection.
  Postgres(const std::string& address, double patience);

  /// Runs `work` within a transaction and commits it. It is run again, once, where the connection is lost before the
  /// commit: until then nothing of it counts, so that it has to change nothing else.
  template <class Work>
  auto transaction(const Work& work) {
    const auto asked = Clock::now();
    const std::lock_guard lock(mutex_);
    // Who has waited long for its turn while the database did not answer is not to wait for it once more. Who has only
    // just come asks it: it may be there again.
    if (silence_ && silence_->noticed > asked + long_wait) throw failure("store.unavailable", silence_->reason);
    return translated([&] {
      for (bool again = connection_ != nullptr;; again = false) {
        bool committing = false;
        try {
          auto& connection = connected();
          const auto watch = deadline_.watch(connection.sock());
          pqxx::work transaction(connection);
          auto result = work(transaction);
          committing = true;
          transaction.commit();
          return result;
        } catch (const pqxx::broken_connection&) {
          connection_.reset();
          if (committing || !again) throw;
        }
      }
    });
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds long_wait{1};

  pqxx::connection& connected();
  template <class Call>
  auto translated(const Call& call) -> decltype(call()) {
    try {
      return call();
    } catch (const pqxx::pqxx_exception& error) {
      fail(error);
    }
  }
  static Error failure(std::string code, const std::string& reason) {
    return Error(std::move(code), "The store's database reports: " + reason + ".");
  }
  /// Throws it as an error of the store.
  [[noreturn]] void fail(const pqxx::pqxx_exception& error);

  const std::string address_;
  SocketDeadline deadline_;
  std::mutex mutex_;
  std::unique_ptr<pqxx::connection> connection_;
  struct Silence {
    Clock::time_point noticed;
    std::string reason;
  };
  std::optional<Silence> silence_;  ///< of the database, until it is connected again
};

}  // namespace supple::store
