#pragma once

#include <string>
#include <utility>
#include <vector>

#include "supple/access/gate.h"
#include "supple/http/server.h"

namespace supple::routes {

/// Says whose requests are answered.
struct GuardOptions {
  std::string listens_on = "127.0.0.1";      ///< the address, or name, of --host
  std::vector<std::string> allowed_hosts;    ///< names besides those of loopback; setting --allowed-host
  std::vector<std::string> allowed_origins;  ///< "https://supple.example"; setting --allowed-origin
  access::Gate* gate = nullptr;              ///< knows the keys; null: nobody needs one
};

/// Whether a name, or an address, means this machine alone: localhost, 127.0.0.0/8, ::1.
bool is_loopback(const std::string& name);

/// Makes the guard that refuses requests which a page of another site could make a browser send, and, if keys are
/// required, requests whose key does not allow them.
///
/// It throws "http.misdirected_request" (421) if the client means a host that is neither a name of loopback, nor
/// `listens_on`, nor allowed. Whoever owns such a name can make it point here (DNS rebinding), and then the owner's
/// page counts as this server's own. A server that listens beyond loopback also answers to numerical addresses, which
/// nobody can make point elsewhere. "*" allows every name.
///
/// It throws "http.cross_origin" (403) if the header Origin names a page that is neither of the same host, nor of
/// loopback, nor allowed. If a request changes or computes something, Sec-Fetch-Site may say so too.
///
/// The key comes from the header Authorization, or from the session that the cookie names. Requests that only read
/// (GET, HEAD) need the scope read, all others the scope compute. Routes with `needs_no_key` need none, and neither
/// does /metrics if it is asked for on the machine itself. The guard sets `key`, `client`, `is_admin` and
/// `max_waiting_jobs` of a request that has a key. It throws "access.key_required", "access.key_invalid",
/// "access.scope", "access.rate".
http::Server::Guard make_guard(GuardOptions options);

/// The cookie that holds the token of a browser's session.
inline constexpr std::string_view session_cookie = "supple_session";
/// The value of that cookie in a request; empty if there is none.
std::string session_of(const http::Request& request);

/// Headers of every answer that does not set them itself. With them, browsers do not guess types, and do not run, embed
/// or store answers.
std::vector<std::pair<std::string, std::string>> security_headers();

}  // namespace supple::routes
