#include <array>
#include <new>

#include "hasher.h"
#include "supple/store/store.h"

namespace supple::store {

std::string hexadecimal_text(std::span<const unsigned char> bytes) {
  constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

Hasher::Hasher() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
  if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) throw std::bad_alloc();
}

void Hasher::add(std::string_view bytes) {
  if (EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) != 1) throw std::bad_alloc();
}

std::string Hasher::hexadecimal() {
  std::array<unsigned char, 32> digest{};
  if (EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr) != 1) throw std::bad_alloc();
  return hexadecimal_text(digest);
}

std::string sha256(std::string_view bytes, const CancellationToken& cancellation) {
  constexpr std::size_t max_bytes_at_once = 1 << 20;
  Hasher hasher;
  while (!bytes.empty()) {
    cancellation.throw_if_requested();
    const auto piece = bytes.substr(0, max_bytes_at_once);
    hasher.add(piece);
    bytes.remove_prefix(piece.size());
  }
  return hasher.hexadecimal();
}

}  // namespace supple::store
