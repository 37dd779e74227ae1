#pragma once

#include <string>
#include <string_view>

namespace supple::access {

/// A permission of a key: `read` allows reading stored objects, `compute` allows computing, storing, and deleting the
/// key's own objects, and `admin` allows all of this for the objects of every key.
enum class Scope : unsigned { read = 1, compute = 2, admin = 4 };

std::string_view scope_name(Scope scope);

/// A set of scopes.
class Scopes {
 public:
  void add(Scope scope) { bits_ |= static_cast<unsigned>(scope); }
  /// Whether the set allows what needs this scope; `admin` includes the other two.
  bool allow(Scope scope) const {
    return (bits_ & (static_cast<unsigned>(scope) | static_cast<unsigned>(Scope::admin))) != 0;
  }
  bool empty() const { return bits_ == 0; }
  friend bool operator==(const Scopes&, const Scopes&) = default;

 private:
  unsigned bits_ = 0;
};

/// The names of the scopes: "read,compute".
std::string scopes_text(Scopes scopes);
/// Parses names that are separated by commas. Throws std::runtime_error for an unknown name and for an empty text.
Scopes parse_scopes(std::string_view text);

}  // namespace supple::access
