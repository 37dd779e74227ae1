#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "failure.h"

namespace supple::cli {

/// A failure with the problem document (RFC 9457) that the server sent.
class Problem : public Failure {
 public:
  Problem(ExitCode code, int status, const std::string& message, nlohmann::json document)
      : Failure(code, message), status_(status), document_(std::move(document)) {}

  /// The HTTP status of the answer.
  int status() const noexcept { return status_; }

  /// The problem document.
  const nlohmann::json& document() const noexcept { return document_; }

 private:
  int status_;
  nlohmann::json document_;
};

/// Throws the failure for a 4xx or 5xx answer. If the body is a problem document, this is a Problem with the server's
/// sentence. The message quotes the beginning of any other body.
[[noreturn]] void throw_problem(int status, const std::string& body);

/// The text of an object's member; empty if there is none.
std::string member_text(const nlohmann::json& object, const char* key);

}  // namespace supple::cli
