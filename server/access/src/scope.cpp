#include "supple/access/scope.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace supple::access {
namespace {

constexpr std::array<std::pair<Scope, std::string_view>, 3> names{
    {{Scope::read, "read"}, {Scope::compute, "compute"}, {Scope::admin, "admin"}}};

Scope scope_of(std::string_view name) {
  for (const auto& [scope, text] : names)
    if (text == name) return scope;
  throw std::runtime_error("there is no scope '" + std::string(name) + "'; the scopes are read, compute and admin");
}

}  // namespace

std::string_view scope_name(Scope scope) {
  return std::find_if(names.begin(), names.end(), [&](const auto& entry) { return entry.first == scope; })->second;
}

std::string scopes_text(Scopes scopes) {
  std::string text;
  for (const auto& [scope, name] : names) {
    Scopes extended = scopes;
    extended.add(scope);
    if (extended != scopes) continue;
    if (!text.empty()) text += ',';
    text += name;
  }
  return text;
}

Scopes parse_scopes(std::string_view text) {
  Scopes scopes;
  while (true) {
    const auto comma = text.find(',');
    scopes.add(scope_of(text.substr(0, comma)));
    if (comma == std::string_view::npos) return scopes;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace supple::access
