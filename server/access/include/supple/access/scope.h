#pragma once

#include <string>
#include <string_view>

namespace supple::access {

/// What a key may do: `read` asks for what is stored, `compute` computes, stores and deletes what is its own, `admin`
/// does all of this with what any key owns.
enum class Scope : unsigned { read = 1, compute = 2, admin = 4 };

std::string_view scope_name(Scope scope);

/// A set of scopes.
class Scopes {
 public:
  void add(Scope scope) { bits_ |= static_cast<unsigned>(scope); }
  /// `admin` has the other two.
  bool allow(Scope scope) const {
    return (bits_ & (static_cast<unsigned>(scope) | static_cast<unsigned>(Scope::admin))) != 0;
  }
  bool empty() const { return bits_ == 0; }
  friend bool operator==(const Scopes&, const Scopes&) = default;

 private:
  unsigned bits_ = 0;
};

/// "read,compute".
std::string scopes_text(Scopes scopes);
/// Reads names that are separated by commas. Throws std::runtime_error for an unknown name and for none at all.
Scopes parse_scopes(std::string_view text);

}  // namespace supple::access
