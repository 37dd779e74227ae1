#include <optional>

#include "handlers.h"
#include "supple/access/gate.h"
#include "supple/json/answers.h"
#include "supple/json/json_writer.h"
#include "supple/json/requests.h"
#include "supple/routes/guard.h"

namespace supple::routes {
namespace {

/// Limit for a body that holds a key.
constexpr std::uint64_t max_sign_in_bytes = 4096;

http::Response session_response(bool required, const access::Key* key) {
  json::JsonWriter out;
  out.begin_object().field("key_required", required);
  if (key) {
    out.key("key").begin_object().field("id", key->id).field("name", key->name).key("scopes").begin_array();
    for (const auto scope : {access::Scope::read, access::Scope::compute, access::Scope::admin})
      if (key->scopes.allow(scope)) out.string(access::scope_name(scope));
    out.end_array();
    if (key->expires) out.field("expires", json::time_text(1000 * key->expires));
    out.end_object();
  }
  out.end_object();
  auto response = json_response(out.take());
  response.set_header("Cache-Control", "no-store");
  return response;
}

/// The cookie that scripts cannot read, and that browsers send only with requests of this server's own pages: over TLS
/// only, if the page came over TLS.
std::string cookie(const http::Request& request, const std::string& token, std::chrono::seconds age) {
  auto text = std::string(session_cookie) + "=" + token +
              "; Path=/; HttpOnly; SameSite=Strict; Max-Age=" + std::to_string(age.count());
  if (http::lower_case(request.header("Origin")).starts_with("https://")) text += "; Secure";
  return text;
}

http::Response show(const Services& services, const http::Request& request) {
  if (!services.gate || !services.gate->required()) return session_response(false, nullptr);
  const auto authorization = request.header("Authorization");
  const auto session = session_of(request);
  if (authorization.empty() && session.empty()) return session_response(true, nullptr);
  const auto key = services.gate->identify({authorization, session});
  if (key) services.gate->count(*key);
  return session_response(true, key ? &*key : nullptr);
}

http::Response sign_in(const Services& services, const http::Request& request) {
  require_json(request);
  const auto key = json::parse_sign_in(request.body, services.limits.json);
  if (!services.gate || !services.gate->required()) return session_response(false, nullptr);
  const auto session = services.gate->sign_in(key);
  auto response = session_response(true, &session.key);
  response.key = session.key.id;
  response.set_header("Set-Cookie", cookie(request, session.token, access::Sessions::length));
  return response;
}

http::Response sign_out(const Services& services, const http::Request& request) {
  http::Response response;
  if (services.gate) response.key = services.gate->sign_out(session_of(request));
  response.status = 204;
  response.set_header("Set-Cookie", cookie(request, "", std::chrono::seconds(0)));
  return response;
}

}  // namespace

void add_session_routes(http::Router& router, Services& services) {
  const auto add = [&](const char* method, http::Response (*handler)(const Services&, const http::Request&),
                       http::BodyLimit body) {
    router.add({.method = method,
                .pattern = "/v1/session",
                .handler = handler_with(services, handler),
                .body = std::move(body),
                .needs_no_key = true});
  };
  add("GET", show, {});
  add("POST", sign_in, {max_sign_in_bytes, ""});
  add("DELETE", sign_out, {});
}

}  // namespace supple::routes
