#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/access/key_file.h"
#include "supple/access/sessions.h"
#include "supple/access/token_bucket.h"

namespace supple::access {

/// When a request needs a key.
enum class Rule {
  never,           ///< with --open
  where_keys_are,  ///< once a key file exists; for a server that listens on loopback only
  always           ///< for a server that others can reach
};

/// Decides which requests a client may send. Any thread may call; calls are serialized and take a few microseconds.
///
/// The key file is checked at most once a second, and its changes take effect without a restart. If it cannot be read
/// any more, the keys that were read before remain valid, and the log says so. Once keys are required, they remain
/// required until the process ends, even if the file disappears.
class Gate {
 public:
  using Clock = std::chrono::steady_clock;
  using Log = std::function<void(const std::string&)>;
  /// The current time on two clocks.
  struct Time {
    std::int64_t date = 0;     ///< seconds since 1970, for the expiry of keys
    Clock::time_point steady;  ///< a clock that nobody sets, for rates and sessions
  };
  static Time system_time();

  /// Throws std::runtime_error if the file cannot be read, and if keys are required but the file contains none: then
  /// nobody could send a request.
  Gate(KeyFile file, Rule rule, Log log = {}, std::function<Time()> time = system_time);

  /// Whether requests need a key now.
  bool required();

  /// The credentials that a request contains; empty if it has none.
  struct Credentials {
    std::string_view authorization;  ///< value of the header Authorization, "Bearer supple_..."
    std::string_view session;        ///< token of a browser's session
  };
  /// The key of the credentials; nothing if no key is required. Throws "access.key_required" and "access.key_invalid".
  std::optional<Key> identify(const Credentials& credentials);
  /// Whether credentials that have been accepted before are still valid: the key is neither revoked nor expired, and
  /// the session is open. This counts no request.
  bool still_valid(const Credentials& credentials);
  /// Counts a request of the key. Throws "access.rate" if the key exceeds its rate.
  void count(const Key& key);
  /// Counts a request as `count` does. Throws "access.scope" if the key lacks the scope that the request needs.
  void allow(const Key& key, Scope needed);
  /// Throws "access.scope" if the key with this id lacks a scope, for requests of which only some need it. Counts
  /// nothing.
  void require_scope(const std::string& id, Scope needed);

  /// Bytes that the objects of a key may take in the store; 0 if it has no limit of its own or does not exist.
  std::int64_t max_stored(const std::string& id);

  /// An open session and its key.
  struct SignedIn {
    std::string token;
    Key key;
  };
  /// Opens a session for the holder of a key ("supple_..."), which counts as a request. Throws "access.key_invalid" and
  /// "access.rate".
  SignedIn sign_in(std::string_view key);
  /// Closes a session. Returns the id of its key, or an empty text if there was no such session.
  std::string sign_out(std::string_view session);

 private:
  // The caller of the following functions holds the mutex.
  void reload_if_changed(const Time& now);
  const Key* find(const std::string& id) const;
  /// The key of a token, and the hash of the key that matches the token's secret. Throws "access.key_invalid".
  std::pair<const Key*, const SecretHash*> verified(std::string_view text, const Time& now) const;
  const Key& key_of_session(std::string_view session, const Time& now);
  void count_against_rate(const Key& key, const Time& now);

  const KeyFile file_;
  const Log log_;
  const std::function<Time()> time_;
  const Rule rule_;
  std::mutex mutex_;
  bool required_ = false;
  std::vector<Key> keys_;
  std::string version_;     ///< inode, size, time and mode of the file that was read; empty if there was none
  std::string last_fault_;  ///< the last fault of the file that was logged
  Clock::time_point next_check_{};
  std::map<std::string, TokenBucket> buckets_;  ///< by the key's id
  Sessions sessions_;
};

}  // namespace supple::access
