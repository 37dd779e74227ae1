#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/error.h"
#include "supple/http/message.h"

namespace supple::http {

using Handler = std::function<Response(const Request&)>;

/// The largest body that a route takes, in bytes, and the setting that limits it.
struct BodyLimit {
  std::uint64_t bytes = 0;
  std::string setting;
};

struct Route {
  std::string method;
  std::string pattern;  ///< "/v1/meshes/{mesh}/content": a name in braces stands for one path segment
  Handler handler;
  BodyLimit body;             ///< 0 bytes: the route takes no body
  bool probe = false;         ///< cheap, and needed while the server is busy: has threads of its own
  bool needs_no_key = false;  ///< even if other routes need one
};

/// Finds the route of a request by comparing path segments. Routes are added before the server runs.
class Router {
 public:
  void add(Route route) { routes_.push_back(std::move(route)); }

  struct Match {
    const Route* route = nullptr;
    std::map<std::string, std::string> path_parameters;
  };
  /// The route of a request; HEAD finds the route of GET. Throws "http.method_not_allowed" if the path exists
  /// for other methods only, "http.not_found" if it does not exist.
  Match find(std::string_view method, std::string_view path) const;

  /// The methods of a path as "GET, POST"; empty for a path that does not exist.
  std::string allowed(std::string_view path) const;

 private:
  std::vector<Route> routes_;
};

}  // namespace supple::http
