#include "supple/routes/guard.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "supple/base/error.h"

namespace supple::routes {
namespace {

/// The name in "name:port", without brackets and the root's dot.
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

bool contains(const std::vector<std::string>& list, const std::string& text) {
  return std::find(list.begin(), list.end(), text) != list.end();
}

/// The host in an origin: "localhost:8080" in "http://localhost:8080"; empty for "null" and other schemes.
std::string_view host_of_origin(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme)) return origin.substr(scheme.size());
  }
  return {};
}

bool only_reads(const std::string& method) { return method == "GET" || method == "HEAD" || method == "OPTIONS"; }

/// The options in the form in which each request is checked.
struct PreparedOptions {
  explicit PreparedOptions(GuardOptions given) : options(std::move(given)) {
    for (auto& host : options.allowed_hosts) host = name_of(host);
    for (auto& origin : options.allowed_origins) origin = http::lower_case(origin);
    options.listens_on = http::lower_case(options.listens_on);
    beyond_loopback = !is_loopback(options.listens_on);
  }
  GuardOptions options;
  bool beyond_loopback = false;
};

void check_host(const PreparedOptions& prepared, const http::Request& request) {
  const auto& options = prepared.options;
  const auto name = name_of(request.host);
  const bool known = name.empty() || is_loopback(name) || name == options.listens_on ||
                     (prepared.beyond_loopback && is_address(name)) || contains(options.allowed_hosts, name) ||
                     contains(options.allowed_hosts, "*");
  if (!known) {
    throw Error("http.misdirected_request", "The server does not answer to the name " + name.substr(0, 80) +
                                                " in the header Host (setting --allowed-host).");
  }
}

void check_origin(const PreparedOptions& prepared, const http::Request& request) {
  const auto origin = http::lower_case(request.header("Origin"));
  if (origin.empty()) {
    if (!only_reads(request.method) && request.header("Sec-Fetch-Site") == "cross-site") {
      throw Error("http.cross_origin", "A browser says that a page of another site sends this request.");
    }
    return;
  }
  const auto host = host_of_origin(origin);
  const bool same = !host.empty() && (host == http::lower_case(request.host) || is_loopback(name_of(host)));
  if (!same && !contains(prepared.options.allowed_origins, origin)) {
    throw Error("http.cross_origin", "A page of " + origin.substr(0, 80) +
                                         " sends this request, not one of this server (setting --allowed-origin).");
  }
}

/// Whether the cookie of a request counts. A browser also sends it with requests of other pages of the same host, such
/// as those of another port, but only a page of this server, or one that is allowed, acts for whoever has signed in.
bool cookie_counts(const PreparedOptions& prepared, const http::Request& request) {
  const auto origin = http::lower_case(request.header("Origin"));
  const auto site = request.header("Sec-Fetch-Site");
  if (origin.empty()) return only_reads(request.method) ? site != "cross-site" : site == "same-origin";
  return host_of_origin(origin) == http::lower_case(request.host) || contains(prepared.options.allowed_origins, origin);
}

/// Whether a request was sent on this machine to this server, and not passed on by a proxy.
bool is_local(const http::Request& request) {
  return is_loopback(request.client) && is_loopback(name_of(request.host)) && request.header("Forwarded").empty() &&
         request.header("X-Forwarded-For").empty() && request.header("Via").empty();
}

void check_key(const PreparedOptions& prepared, http::Request& request, const http::Route* route) {
  if (!prepared.options.gate || !route || route->needs_no_key || !prepared.options.gate->required()) return;
  if (route->pattern == "/metrics" && is_local(request)) return;
  const auto authorization = request.header("Authorization");
  const auto session = cookie_counts(prepared, request) ? session_of(request) : std::string();
  const auto key = prepared.options.gate->identify({authorization, session});
  if (!key) return;
  request.key = key->id;
  request.client = "key " + key->id;
  request.is_admin = key->scopes.allow(access::Scope::admin);
  request.max_waiting_jobs = key->max_waiting_jobs;
  prepared.options.gate->allow(*key, only_reads(request.method) ? access::Scope::read : access::Scope::compute);
}

}  // namespace

bool is_loopback(const std::string& name) {
  return name == "localhost" || name.ends_with(".localhost") || name == "::1" ||
         (name.starts_with("127.") && is_address(name));
}

http::Server::Guard make_guard(GuardOptions options) {
  return [prepared = PreparedOptions(std::move(options))](http::Request& request, const http::Route* route) {
    check_host(prepared, request);
    check_origin(prepared, request);
    check_key(prepared, request, route);
  };
}

std::string session_of(const http::Request& request) {
  const auto header = request.header("Cookie");
  std::string_view rest = header;
  while (!rest.empty()) {
    const auto end = rest.find_first_of(";,");  // repeated headers are joined by commas
    auto pair = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    pair.remove_prefix(std::min(pair.find_first_not_of(' '), pair.size()));
    if (pair.starts_with(session_cookie) && pair.substr(session_cookie.size()).starts_with('='))
      return std::string(pair.substr(session_cookie.size() + 1));
  }
  return {};
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
