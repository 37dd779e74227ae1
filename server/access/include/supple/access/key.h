#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "supple/access/scope.h"

namespace supple::access {

/// The salted hash of a secret. The secret itself is stored nowhere.
struct SecretHash {
  std::string salt;    ///< 128 random bits, hexadecimal
  std::string digest;  ///< SHA-256 of salt and secret, hexadecimal
  friend bool operator==(const SecretHash&, const SecretHash&) = default;
};

/// A key of the key file. Times are in seconds since 1970.
struct Key {
  std::string id;    ///< 12 hexadecimal digits; not secret: it is logged, and identifies the owner of meshes and jobs
  std::string name;  ///< a name for people
  Scopes scopes;
  SecretHash secret;
  std::optional<SecretHash> previous;  ///< the secret before the last rotation
  std::int64_t previous_until = 0;     ///< the previous secret is accepted before this time
  std::int64_t created = 0;
  std::int64_t expires = 0;     ///< the key is accepted before this time; 0: it never expires
  int requests_per_minute = 0;  ///< 0: no limit
  int max_waiting_jobs = 0;     ///< 0: no limit but that of the queue
  std::int64_t max_stored = 0;  ///< bytes of its stored meshes, results and requests of jobs; 0: no limit of its own
};

/// The key as its holder sends it: "supple_<id>_<secret>".
struct Token {
  std::string id;
  std::string secret;  ///< 256 random bits, hexadecimal
};
/// Parses a token. Returns nothing for text of another form.
std::optional<Token> parse_token(std::string_view text);
std::string token_text(const Token& token);

/// The given number of cryptographically random bytes in hexadecimal digits. Throws std::runtime_error if the system
/// provides none.
std::string random_hex(std::size_t bytes);
/// The SHA-256 of the bytes in hexadecimal digits.
std::string digest_of(std::string_view bytes);

std::string new_key_id();
std::string new_secret();

/// Hashes a secret with a new salt. One application of SHA-256 suffices: a password would need a slow function, but a
/// secret of 256 random bits cannot be guessed at any speed.
SecretHash hash_secret(const std::string& secret);
/// Whether a secret has this hash. The comparison takes about a microsecond, and its time does not reveal where the two
/// differ.
bool matches(const SecretHash& hash, const std::string& secret);

/// The hash of the key that matches the secret at the time `now` (seconds since 1970): the current hash, or the
/// previous one while it is accepted. Null if neither matches. The expiry of the key itself is not checked.
const SecretHash* accepted_hash(const Key& key, const std::string& secret, std::int64_t now);

}  // namespace supple::access
