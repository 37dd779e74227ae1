#include "entity_tag.h"

namespace supple::routes {

std::string quoted(const std::string& tag) { return '"' + tag + '"'; }

bool matches(const std::string& header, const std::string& tag) {
  return header == "*" || header.find(quoted(tag)) != std::string::npos;
}

http::Response not_modified(const std::string& tag) {
  http::Response response;
  response.status = 304;
  response.set_header("ETag", quoted(tag));
  return response;
}

}  // namespace supple::routes
