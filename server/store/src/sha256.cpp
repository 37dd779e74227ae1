#include <openssl/evp.h>

#include <array>
#include <memory>
#include <new>

#include "supple/store/store.h"

namespace supple::store {

std::string sha256(std::string_view bytes, const CancellationToken& cancellation) {
  constexpr std::size_t most_at_once = 1 << 20;
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  bool good = context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  while (good && !bytes.empty()) {
    cancellation.throw_if_requested();
    const auto piece = bytes.substr(0, most_at_once);
    good = EVP_DigestUpdate(context.get(), piece.data(), piece.size()) == 1;
    bytes.remove_prefix(piece.size());
  }
  std::array<unsigned char, 32> digest{};
  if (!good || EVP_DigestFinal_ex(context.get(), digest.data(), nullptr) != 1) throw std::bad_alloc();
  constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : digest) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

}  // namespace supple::store
