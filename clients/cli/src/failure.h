#pragma once

#include <stdexcept>
#include <string>

#include "exit_code.h"

namespace supple::cli {

/// Ends a command: the sentence goes to standard error, the code to the caller.
class Failure : public std::runtime_error {
 public:
  Failure(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

}  // namespace supple::cli
