#include "supple/routes/audit.h"

namespace supple::routes {
namespace {

constexpr int bad_request = 400;
constexpr int unauthorized = 401;
constexpr int forbidden = 403;

bool succeeded(int status) { return status >= 200 && status < 300; }

/// The word for what a request has done; empty if the log says nothing of it.
std::string action_of(const http::AnsweredRequest& answered) {
  const bool session = answered.pattern == "/v1/session";
  if (session && answered.method == "POST") return succeeded(answered.status) ? "sign-in" : "sign-in-refused";
  if (answered.status == unauthorized || answered.status == forbidden) return "refused";
  if (!succeeded(answered.status)) return {};
  if (answered.method == "DELETE") return session ? "sign-out" : "delete";
  return answered.location.empty() ? "" : "create";
}

}  // namespace

std::string plain_text(const std::string& text) {
  constexpr std::size_t max_length = 200;
  if (text.empty()) return "-";
  std::string plain;
  for (const char c : text.substr(0, max_length)) plain += c > 0x20 && c < 0x7f ? c : '?';
  return plain;
}

std::string audit_line(const http::AnsweredRequest& answered) {
  const auto action = action_of(answered);
  if (action.empty()) return {};
  const auto& object = action == "create" ? answered.location : answered.path;
  return "audit " + plain_text(answered.id) + " key=" + plain_text(answered.key) +
         " address=" + plain_text(answered.address) + " action=" + action + " method=" + plain_text(answered.method) +
         " object=" + plain_text(object) + " status=" + std::to_string(answered.status);
}

void AuditLog::note(const http::AnsweredRequest& answered, Clock::time_point now) {
  const auto line = audit_line(answered);
  if (line.empty()) return;
  const std::lock_guard lock(mutex_);
  if (now - second_ >= std::chrono::seconds(1)) {
    if (refusals_ > max_refusals)
      write_("audit " + std::to_string(refusals_ - max_refusals) + " refusals more than the lines above say");
    second_ = now;
    refusals_ = 0;
  }
  if (answered.status < bad_request || ++refusals_ <= max_refusals) write_(line);
}

}  // namespace supple::routes
