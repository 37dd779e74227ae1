#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "supple/access/scope.h"

namespace supple::access {

/// What is kept of a secret.
struct SecretHash {
  std::string salt;    ///< 128 random bits, hexadecimal
  std::string digest;  ///< SHA-256 of salt and secret, hexadecimal
  friend bool operator==(const SecretHash&, const SecretHash&) = default;
};

/// A key as the key file has it. Times in seconds since 1970.
struct Key {
  std::string id;    ///< 12 hexadecimal digits; public: it is in the log, and owns what the key makes
  std::string name;  ///< for people
  Scopes scopes;
  SecretHash secret;
  std::optional<SecretHash> previous;  ///< of the secret before the last rotation
  std::int64_t previous_until = 0;     ///< that one is accepted before this time
  std::int64_t created = 0;
  std::int64_t expires = 0;     ///< the key is accepted before this time; 0: for ever
  int requests_per_minute = 0;  ///< 0: no limit
  int max_waiting_jobs = 0;     ///< 0: that of the queue alone
  std::int64_t max_stored = 0;  ///< bytes of its meshes, results and requests of jobs; 0: no limit of its own
};

/// What a client sends: "supple_<id>_<secret>".
struct Token {
  std::string id;
  std::string secret;  ///< 256 random bits, hexadecimal
};
/// Nothing for text of another form.
std::optional<Token> parse_token(std::string_view text);
std::string token_text(const Token& token);

/// So many random bytes from the system, hexadecimal. Throws std::runtime_error where it gives none.
std::string random_hex(std::size_t bytes);
/// SHA-256, hexadecimal.
std::string digest_of(std::string_view bytes);

std::string new_key_id();
std::string new_secret();

/// With a salt of its own. One round of SHA-256 is right here, where a password would need a slow function: a secret of
/// 256 random bits is not guessed, however many guesses a second there are.
SecretHash hash_secret(const std::string& secret);
/// Compares in a time that does not depend on where the two differ. About a microsecond.
bool matches(const SecretHash& hash, const std::string& secret);

/// The hash of the key that accepts the secret at a time (seconds since 1970): the current one, or that before the last
/// rotation while it counts. Null where none does. Does not look at the key's own expiry.
const SecretHash* accepting(const Key& key, const std::string& secret, std::int64_t now);

}  // namespace supple::access
