#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "supple/access/key.h"

namespace supple::access {

/// Sessions of browsers. After signing in with a key, a browser keeps only a token that expires. Sessions are in memory
/// only, so that a restart of the server ends them; of a token only the SHA-256 is stored. One thread at a time may
/// call.
class Sessions {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::hours length{8};  ///< a working day
  static constexpr std::size_t max_per_key = 32;  ///< sessions of one key; opening another one ends the oldest

  struct Session {
    std::string key;  ///< id of the key
    /// Hash of the secret that opened the session. The session ends once the key no longer accepts that secret.
    SecretHash secret;
    Clock::time_point end;
  };

  /// Opens a session and returns its token: 256 random bits in hexadecimal digits.
  std::string open(const std::string& key, const SecretHash& secret, Clock::time_point now);
  /// The session of a token; null if the token is unknown or the session has ended.
  const Session* find(const std::string& token, Clock::time_point now);
  void close(const std::string& token);

 private:
  void drop_ended(Clock::time_point now);

  std::map<std::string, Session> sessions_;  ///< by the token's SHA-256
};

}  // namespace supple::access
