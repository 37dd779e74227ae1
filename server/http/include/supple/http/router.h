#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/http/message.h"

namespace supple::http {

using Handler = std::function<Response(const Request&)>;

/// Most bytes of a body that a route takes, and the setting that says so.
struct BodyLimit {
  std::uint64_t bytes = 0;
  std::string setting;
};

struct Route {
  std::string method;
  std::string pattern;  ///< "/v1/meshes/{mesh}/content": names in braces stand for one segment each
  Handler handler;
  BodyLimit body;      ///< 0 bytes: the route takes no body
  bool probe = false;  ///< cheap, and needed when all else is busy: answered by threads of its own
  bool open = false;   ///< answered without a key, also where keys are required
};

/// Finds the handler of a request by comparing path segments. Filled before the server runs, read only afterwards.
class Router {
 public:
  void add(Route route) { routes_.push_back(std::move(route)); }

  struct Match {
    const Route* route = nullptr;
    std::map<std::string, std::string> path_parameters;
  };
  /// HEAD finds the route of GET. Throws "http.not_found", or "http.method_not_allowed" where the path exists.
  Match find(std::string_view method, std::string_view path) const;

  /// The methods of a path, "GET, POST"; empty for a path that does not exist.
  std::string allowed(std::string_view path) const;

 private:
  std::vector<Route> routes_;
};

}  // namespace supple::http
