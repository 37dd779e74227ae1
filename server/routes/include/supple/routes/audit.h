#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

#include "supple/http/server.h"

namespace supple::routes {

/// The line of the audit log about a request: who made or deleted what, was refused it, or signed in or out. Empty for
/// requests that only read or compute. The line names a key by its id, and has no part of a secret, of a query or of a
/// body. It is one line of plain characters, whatever a stranger has sent.
std::string audit_line(const http::AnsweredRequest& answered);

/// Writes the audit log. Strangers can cause refusals at will: at most `max_refusals` of them get a line in each
/// second, and the next line after them says how many more there were. Any thread may call.
class AuditLog {
 public:
  using Clock = std::chrono::steady_clock;
  using Write = std::function<void(const std::string& line)>;
  static constexpr int max_refusals = 20;

  explicit AuditLog(Write write) : write_(std::move(write)) {}
  void note(const http::AnsweredRequest& answered, Clock::time_point now = Clock::now());

 private:
  const Write write_;
  std::mutex mutex_;
  Clock::time_point second_{};  ///< begin of the second in which refusals are counted
  int refusals_ = 0;
};

/// Text of a stranger for a line of a log: its first 200 characters, with question marks for those that are not plain;
/// "-" if it is empty.
std::string plain_text(const std::string& text);

}  // namespace supple::routes
