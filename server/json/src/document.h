#pragma once

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "supple/base/cancellation.h"
#include "supple/json/limits.h"

namespace supple::json {

using Document = nlohmann::json;

/// A document that is destroyed from its leaves on. The destructor of the library first collects the children of an
/// array, for which it allocates: where memory is short, that ends the process.
class OwnedDocument {
 public:
  OwnedDocument() = default;
  OwnedDocument(OwnedDocument&& other) noexcept : root_(std::move(other.root_)) {}
  OwnedDocument(const OwnedDocument&) = delete;
  OwnedDocument& operator=(const OwnedDocument&) = delete;
  OwnedDocument& operator=(OwnedDocument&&) = delete;
  ~OwnedDocument();

  Document& root() { return root_; }
  operator const Document&() const { return root_; }

 private:
  Document root_;
};

/// Parses a body from a stranger in one pass, counting as it goes. Throws "request.not_utf8", "request.malformed_json"
/// (with the byte, and for repeated keys), "request.too_deep", "request.too_many_values", and the error of a stop
/// request.
OwnedDocument parse_document(std::string_view text, const Limits& limits, const CancellationToken& cancellation = {});

}  // namespace supple::json
