#include "supple/routes/audit.h"

namespace supple::routes {
namespace {

constexpr int unauthorized = 401;
constexpr int forbidden = 403;

bool succeeded(int status) { return status >= 200 && status < 300; }

/// Empty where nothing is to be said.
std::string action_of(const http::Answered& answered) {
  const bool session = answered.pattern == "/v1/session";
  if (session && answered.method == "POST") return succeeded(answered.status) ? "sign-in" : "sign-in-refused";
  if (answered.status == unauthorized || answered.status == forbidden) return "refused";
  if (!succeeded(answered.status)) return {};
  if (answered.method == "DELETE") return session ? "sign-out" : "delete";
  return answered.location.empty() ? "" : "create";
}

}  // namespace

std::string plain_text(const std::string& text) {
  constexpr std::size_t most = 200;
  if (text.empty()) return "-";
  std::string plain;
  for (const char c : text.substr(0, most)) plain += c > 0x20 && c < 0x7f ? c : '?';
  return plain;
}

std::string audit_line(const http::Answered& answered) {
  const auto action = action_of(answered);
  if (action.empty()) return {};
  const auto& object = action == "create" ? answered.location : answered.path;
  return "audit " + plain_text(answered.id) + " key=" + plain_text(answered.key) +
         " address=" + plain_text(answered.address) + " action=" + action + " method=" + plain_text(answered.method) +
         " object=" + plain_text(object) + " status=" + std::to_string(answered.status);
}

}  // namespace supple::routes
