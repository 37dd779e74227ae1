#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <pqxx/pqxx>
#include <string>
#include <utility>

#include "socket_deadline.h"
#include "supple/store/store_error.h"

namespace supple::store {

/// A connection to a PostgreSQL database, which is made again once it is lost. Any thread may call; calls run one after
/// the other.
///
/// Errors throw "store.full" where the disk of the database is full, "store.unavailable" otherwise.
class Postgres {
 public:
  /// Does not connect yet. `address` is a connection string of libpq. Unless it has other limits for a machine that
  /// does not answer, an attempt to connect is given up after 3 seconds. The system closes a connection where nothing
  /// that was sent has been acknowledged for 5 seconds. A transaction that takes longer than `transaction_timeout`, in
  /// seconds, is given up with its connection.
  Postgres(const std::string& address, double transaction_timeout);

  /// Runs `work` within a transaction and commits it. If a connection of an earlier call turns out to be lost before
  /// the commit, `work` is run once more on a new one. Therefore it must change nothing outside of the transaction.
  template <class Work>
  auto transaction(const Work& work) {
    const auto called_at = Clock::now();
    const std::lock_guard lock(mutex_);
    // If the database was found silent while this caller waited long for the mutex, the caller does not wait for the
    // database too. A caller that came just before tries to connect, for the database may be there again.
    if (outage_ && outage_->noticed > called_at + long_wait) throw StoreUnavailable(report(outage_->reason));
    return with_store_errors([&] {
      for (bool again = connection_ != nullptr;; again = false) {
        bool committing = false;
        try {
          auto& connection = ensure_connected();
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

  pqxx::connection& ensure_connected();
  template <class Call>
  auto with_store_errors(const Call& call) -> decltype(call()) {
    try {
      return call();
    } catch (const pqxx::pqxx_exception& error) {
      fail(error);
    }
  }
  static std::string report(const std::string& reason) { return "The store's database reports: " + reason + "."; }
  /// Throws an error of the store with the text of `error`.
  [[noreturn]] void fail(const pqxx::pqxx_exception& error);

  const std::string address_;
  SocketDeadline deadline_;
  std::mutex mutex_;
  std::unique_ptr<pqxx::connection> connection_;
  struct Outage {
    Clock::time_point noticed;
    std::string reason;
  };
  std::optional<Outage> outage_;  ///< set while the database does not answer
};

}  // namespace supple::store
