#include "supple/access/key.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/rand.h>

#include <array>
#include <new>
#include <span>
#include <stdexcept>
#include <vector>

namespace supple::access {
namespace {

constexpr std::string_view prefix = "supple_";  // lets scanners for leaked secrets recognize a key
constexpr std::size_t id_bytes = 6;
constexpr std::size_t secret_bytes = 32;
constexpr std::size_t salt_bytes = 16;

std::string hexadecimal(std::span<const unsigned char> bytes) {
  constexpr char digits[] = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const unsigned char byte : bytes) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

bool is_hexadecimal(std::string_view text) {
  return text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

}  // namespace

std::string random_hex(std::size_t bytes) {
  std::vector<unsigned char> random(bytes);
  if (RAND_bytes(random.data(), static_cast<int>(bytes)) != 1) throw std::runtime_error("no random bytes");
  return hexadecimal(random);
}

std::string digest_of(std::string_view bytes) {
  std::array<unsigned char, 32> digest{};
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1)
    throw std::bad_alloc();
  return hexadecimal(digest);
}

std::optional<Token> parse_token(std::string_view text) {
  constexpr auto length = prefix.size() + 2 * id_bytes + 1 + 2 * secret_bytes;
  if (text.size() != length || !text.starts_with(prefix)) return std::nullopt;
  text.remove_prefix(prefix.size());
  const auto id = text.substr(0, 2 * id_bytes);
  const auto secret = text.substr(2 * id_bytes + 1);
  if (text[2 * id_bytes] != '_' || !is_hexadecimal(id) || !is_hexadecimal(secret)) return std::nullopt;
  return Token{std::string(id), std::string(secret)};
}

std::string token_text(const Token& token) { return std::string(prefix) + token.id + "_" + token.secret; }

std::string new_key_id() { return random_hex(id_bytes); }
std::string new_secret() { return random_hex(secret_bytes); }

SecretHash hash_secret(const std::string& secret) {
  auto salt = random_hex(salt_bytes);
  auto digest = digest_of(salt + secret);
  return {std::move(salt), std::move(digest)};
}

bool matches(const SecretHash& hash, const std::string& secret) {
  const auto digest = digest_of(hash.salt + secret);
  return digest.size() == hash.digest.size() && CRYPTO_memcmp(digest.data(), hash.digest.data(), digest.size()) == 0;
}

const SecretHash* accepted_hash(const Key& key, const std::string& secret, std::int64_t now) {
  if (matches(key.secret, secret)) return &key.secret;
  if (key.previous && now < key.previous_until && matches(*key.previous, secret)) return &*key.previous;
  return nullptr;
}

}  // namespace supple::access
