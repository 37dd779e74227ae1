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
  never,           ///< --open
  where_keys_are,  ///< from when the key file exists on; the rule of a server that listens on loopback
  always           ///< the rule of one that listens beyond
};

/// Decides who may ask for what. Any thread may call; calls take turns, and take a few microseconds each.
///
/// The key file is looked at again at most once a second: what has changed there counts from then on, without a
/// restart. Where it cannot be read any more, the keys that were read before go on counting, and the log says so. Once
/// keys are required they stay required until the process ends, also where the file disappears.
class Gate {
 public:
  using Clock = std::chrono::steady_clock;
  using Log = std::function<void(const std::string&)>;
  /// What time it is: for keys the seconds since 1970, for rates and sessions a clock that is not set.
  struct Time {
    std::int64_t date = 0;
    Clock::time_point steady;
  };
  static Time system_time();

  /// Throws std::runtime_error where the file cannot be read, or where keys are required and none is in it: then
  /// nobody could ask for anything.
  Gate(KeyFile file, Rule rule, Log log = {}, std::function<Time()> time = system_time);

  /// Whether requests need a key now.
  bool required();

  /// What a request brings along, each empty where it brings none.
  struct Credentials {
    std::string_view authorization;  ///< the header's value, "Bearer supple_..."
    std::string_view session;        ///< the token of a browser's session
  };
  /// The key that they show; nothing where none is required. Throws "access.key_required" and "access.key_invalid".
  std::optional<Key> identify(const Credentials& credentials);
  /// Whether credentials that were identified still are: their key has not been revoked and has not expired, and their
  /// session is open. Counts no request.
  bool still_valid(const Credentials& credentials);
  /// Counts a request of the key. Throws "access.rate" where it sends too many.
  void count(const Key& key);
  /// Counts a request of the key, as `count` does, and throws "access.scope" where the key has not what the request
  /// needs.
  void allow(const Key& key, Scope needed);

  /// Bytes that a key may hold in the store; 0 where it has no limit of its own, or does not exist.
  std::int64_t max_stored(const std::string& id);

  /// Opens a session for the holder of a key ("supple_..."), which counts as a request of the key. Throws
  /// "access.key_invalid" and "access.rate".
  struct SignedIn {
    std::string token;
    Key key;
  };
  SignedIn sign_in(std::string_view key);
  /// Returns the id of its key; empty where there was no such session.
  std::string sign_out(std::string_view session);

 private:
  void look_at_file(const Time& now);
  const Key* find(const std::string& id) const;
  /// Under the mutex: the key that accepts a token, and its hash that does. Throws "access.key_invalid".
  std::pair<const Key*, const SecretHash*> verified(std::string_view text, const Time& now) const;
  const Key& key_of_session(std::string_view session, const Time& now);
  void take_from_rate(const Key& key, const Time& now);

  const KeyFile file_;
  const Log log_;
  const std::function<Time()> time_;
  const Rule rule_;
  std::mutex mutex_;
  bool required_ = false;
  std::vector<Key> keys_;
  std::string version_;    ///< of the file that was read: inode, size and time; empty where there was none
  std::string complaint_;  ///< about the file that was said last
  Clock::time_point next_look_{};
  std::map<std::string, TokenBucket> rates_;  ///< by the key's id
  Sessions sessions_;
};

}  // namespace supple::access
