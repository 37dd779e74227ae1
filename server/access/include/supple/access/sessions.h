#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "supple/access/key.h"

namespace supple::access {

/// Sessions of browsers, which hold no key but a token that ends. In memory alone: a restart of the server ends them.
/// Tokens are kept as their SHA-256. Not for several threads at once.
class Sessions {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::hours length{8};    ///< a working day
  static constexpr std::size_t most_of_a_key = 32;  ///< a further one ends the oldest

  struct Session {
    std::string key;    ///< its id
    SecretHash secret;  ///< by which it was opened: once the key does not accept that one any more, it has ended
    Clock::time_point end;
  };

  /// Returns the token: 256 random bits, hexadecimal.
  std::string open(const std::string& key, const SecretHash& secret, Clock::time_point now);
  /// Null for an unknown token and for one that has ended.
  const Session* find(const std::string& token, Clock::time_point now);
  void close(const std::string& token);

 private:
  void drop_ended(Clock::time_point now);

  std::map<std::string, Session> sessions_;  ///< by the token's SHA-256
};

}  // namespace supple::access
