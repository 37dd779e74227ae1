#include "supple/http/router.h"

#include <utility>

namespace supple::http {
namespace {

std::string_view take_segment(std::string_view& path) {
  path.remove_prefix(1);
  const auto segment = path.substr(0, path.find('/'));
  path.remove_prefix(segment.size());
  return segment;
}

bool matches(std::string_view pattern, std::string_view path, std::map<std::string, std::string>* parameters) {
  if (path.empty() || path.front() != '/') return false;
  while (!pattern.empty() && !path.empty()) {
    const auto expected = take_segment(pattern);
    const auto segment = take_segment(path);
    if (expected.starts_with('{') && !segment.empty()) {
      if (parameters) parameters->emplace(expected.substr(1, expected.size() - 2), segment);
    } else if (expected != segment) {
      return false;
    }
  }
  return pattern.empty() && path.empty();
}

}  // namespace

Router::Match Router::find(std::string_view method, std::string_view path) const {
  const std::string_view wanted = method == "HEAD" ? "GET" : method;
  for (const auto& route : routes_) {
    Match match;
    if (route.method == wanted && matches(route.pattern, path, &match.path_parameters)) {
      match.route = &route;
      return match;
    }
  }
  if (const auto methods = allowed(path); !methods.empty()) {
    const auto text = std::string(path) + " does not take " + std::string(method) + "; it takes " + methods + ".";
    throw problem::ProblemError({"http.method_not_allowed", text, {}, {}, {}, methods});
  }
  throw Error("http.not_found", "There is nothing at " + std::string(path) + ".");
}

std::string Router::allowed(std::string_view path) const {
  std::string methods;
  for (const auto& route : routes_) {
    if (!matches(route.pattern, path, nullptr)) continue;
    if (!methods.empty()) methods += ", ";
    methods += route.method;
  }
  return methods;
}

}  // namespace supple::http
