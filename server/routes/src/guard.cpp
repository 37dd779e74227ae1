#include "supple/routes/guard.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "supple/base/error.h"

namespace supple::routes {
namespace {

/// The name of a "name:port", without brackets and the root's dot.
std::string name_of(std::string_view host) {
  if (host.starts_with('[')) return http::lower_case(host.substr(1, std::min(host.find(']'), host.size()) - 1));
  auto name = http::lower_case(host.substr(0, host.find(':')));
  if (name.ends_with('.')) name.pop_back();
  return name;
}

bool is_address(const std::string& name) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return ::inet_pton(AF_INET, name.c_str(), bytes.data()) == 1 ||
         ::inet_pton(AF_INET6, name.c_str(), bytes.data()) == 1;
}

bool is_loopback(const std::string& name) {
  return name == "localhost" || name.ends_with(".localhost") || name == "::1" ||
         (name.starts_with("127.") && is_address(name));
}

bool contains(const std::vector<std::string>& list, const std::string& text) {
  return std::find(list.begin(), list.end(), text) != list.end();
}

/// The host of an origin, "localhost:8080" of "http://localhost:8080"; empty for "null" and other schemes.
std::string_view host_of_origin(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme)) return origin.substr(scheme.size());
  }
  return {};
}

bool only_reads(const std::string& method) { return method == "GET" || method == "HEAD" || method == "OPTIONS"; }

}  // namespace

http::Server::Guard make_guard(GuardOptions options) {
  for (auto& host : options.allowed_hosts) host = name_of(host);
  for (auto& origin : options.allowed_origins) origin = http::lower_case(origin);
  options.listens_on = http::lower_case(options.listens_on);
  const bool beyond_loopback = !is_loopback(options.listens_on);
  return [options = std::move(options), beyond_loopback](const http::Request& request) {
    const auto name = name_of(request.host);
    const bool known = name.empty() || is_loopback(name) || name == options.listens_on ||
                       (beyond_loopback && is_address(name)) || contains(options.allowed_hosts, name) ||
                       contains(options.allowed_hosts, "*");
    if (!known) {
      throw Error("http.misdirected_request", "The server does not answer to the name " + name.substr(0, 80) +
                                                  " in the header Host (setting --allowed-host).");
    }
    const auto origin = http::lower_case(request.header("Origin"));
    if (origin.empty()) {
      if (!only_reads(request.method) && request.header("Sec-Fetch-Site") == "cross-site") {
        throw Error("http.cross_origin", "A browser says that a page of another site sends this request.");
      }
      return;
    }
    const auto host = host_of_origin(origin);
    const bool same = !host.empty() && (host == http::lower_case(request.host) || is_loopback(name_of(host)));
    if (!same && !contains(options.allowed_origins, origin)) {
      throw Error("http.cross_origin", "A page of " + origin.substr(0, 80) +
                                           " sends this request, not one of this server (setting --allowed-origin).");
    }
  };
}

std::vector<std::pair<std::string, std::string>> security_headers() {
  return {{"X-Content-Type-Options", "nosniff"},
          {"Referrer-Policy", "no-referrer"},
          {"Cross-Origin-Resource-Policy", "same-origin"},
          // Drawings that are opened by themselves keep their styles.
          {"Content-Security-Policy", "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'"},
          {"Cache-Control", "no-cache"}};
}

}  // namespace supple::routes
