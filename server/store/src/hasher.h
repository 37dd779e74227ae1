#pragma once

#include <openssl/evp.h>

#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace supple::store {

/// Two hexadecimal digits for each byte.
std::string hexadecimal_text(std::span<const unsigned char> bytes);

/// SHA-256 of bytes that come in pieces. Throws std::bad_alloc where the library has no memory.
class Hasher {
 public:
  Hasher();
  void add(std::string_view bytes);
  /// The hash. May be called once, after the last piece.
  std::string hexadecimal();

 private:
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

}  // namespace supple::store
