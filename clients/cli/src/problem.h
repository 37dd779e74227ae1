#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "failure.h"

namespace supple::cli {

/// The failure that a problem document (RFC 9457) of the server stands for.
class Problem : public Failure {
 public:
  Problem(ExitCode code, int status, const std::string& message, nlohmann::json document)
      : Failure(code, message), status_(status), document_(std::move(document)) {}

  /// Of the answer.
  int status() const noexcept { return status_; }

  /// What the server sent.
  const nlohmann::json& document() const noexcept { return document_; }

 private:
  int status_;
  nlohmann::json document_;
};

/// The failure that a 4xx or 5xx answer stands for: where the body is a problem document a Problem with the server's
/// sentence. Any other body is quoted shortened.
[[noreturn]] void throw_problem(int status, const std::string& body);

/// A text among the members of an object; empty where there is none.
std::string member_text(const nlohmann::json& object, const char* key);

}  // namespace supple::cli
