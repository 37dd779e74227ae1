#pragma once

#include <string>
#include <utility>
#include <vector>

#include "supple/access/gate.h"
#include "supple/http/server.h"

namespace supple::routes {

/// Whose requests are answered.
struct GuardOptions {
  std::string listens_on = "127.0.0.1";      ///< the address, or name, of --host
  std::vector<std::string> allowed_hosts;    ///< names besides those of loopback; setting --allowed-host
  std::vector<std::string> allowed_origins;  ///< "https://supple.example"; setting --allowed-origin
  access::Gate* gate = nullptr;              ///< that knows the keys; null: nobody needs one
};

/// Whether a name, or an address, means this machine alone: localhost, 127.0.0.0/8, ::1.
bool is_loopback(const std::string& name);

/// Refuses what a page of another site could make a browser send to this server, and where keys are required what
/// brings none that may do it.
///
/// "http.misdirected_request" (421) where the host that the client means is neither a name of loopback, nor
/// `listens_on`, nor allowed: such a name may be made to point here by whoever owns it (DNS rebinding), whose page then
/// counts as this server's own. A server that listens beyond loopback also answers to numerical addresses, which nobody
/// can make point elsewhere. "*" allows every name. "http.cross_origin" (403) where the header Origin names a page that
/// is neither of the same host, nor of loopback, nor allowed, and where Sec-Fetch-Site says so of a request that
/// changes or computes something.
///
/// Then the key, of the header Authorization or of the session that the cookie names: what only reads (GET, HEAD) needs
/// the scope read, all else compute. Open routes need no key, and /metrics none where it is asked for on the machine
/// itself. Of requests that have a key it sets `key`, `client`, `is_admin` and `max_waiting_jobs`. Throws
/// "access.key_required", "access.key_invalid", "access.scope", "access.rate".
http::Server::Guard make_guard(GuardOptions options);

/// The cookie that holds the token of a browser's session.
inline constexpr std::string_view session_cookie = "supple_session";
/// Its value in a request; empty where there is none.
std::string session_of(const http::Request& request);

/// Headers of every answer that does not set them itself: browsers neither guess types, nor run, embed, or keep what
/// they get.
std::vector<std::pair<std::string, std::string>> security_headers();

}  // namespace supple::routes
