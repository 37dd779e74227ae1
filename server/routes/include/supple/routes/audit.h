#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

#include "supple/http/server.h"

namespace supple::routes {

/// What the audit log says of an answered request: who made, deleted or was refused what, and signed in or out; empty
/// where it says nothing, as of what only reads or computes. It knows a key by its id; no part of a secret, no query
/// and no body is in it. One line of plain characters, whatever a stranger has sent.
std::string audit_line(const http::AnsweredRequest& answered);

/// Writes the audit log. Of refusals, which strangers can cause at will, at most `most_refusals` a second get a line of
/// their own; the next line after them says how many more there were. Any thread may call.
class AuditLog {
 public:
  using Clock = std::chrono::steady_clock;
  using Write = std::function<void(const std::string& line)>;
  static constexpr int most_refusals = 20;

  explicit AuditLog(Write write) : write_(std::move(write)) {}
  void note(const http::AnsweredRequest& answered, Clock::time_point now = Clock::now());

 private:
  const Write write_;
  std::mutex mutex_;
  Clock::time_point second_{};  ///< in which refusals are counted
  int refusals_ = 0;
};

/// Text of a stranger for a line of a log: at most 200 characters, others than plain ones as question marks; "-" for
/// none.
std::string plain_text(const std::string& text);

}  // namespace supple::routes
