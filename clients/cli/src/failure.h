#pragma once

#include <stdexcept>
#include <string>

#include "exit_code.h"

namespace supple::cli {

/// An error that ends a command: the message goes to standard error, and the code is the program's exit code.
class Failure : public std::runtime_error {
 public:
  Failure(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

}  // namespace supple::cli
