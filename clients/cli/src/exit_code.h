#pragma once

namespace supple::cli {

/// Exit codes of the program; `supple --help` lists the same numbers.
enum class ExitCode : int {
  success = 0,
  usage = 1,         ///< the command line cannot be understood
  rejected = 2,      ///< the server answered 4xx: the request cannot be fulfilled
  server_error = 3,  ///< the server answered 5xx
  unreachable = 4,   ///< no server answered, or the connection broke
  local_file = 5,    ///< a local file cannot be read or written
  violations = 6,    ///< a G-code file violates a rule, or a family's definition has faults
  missed = 7,        ///< a design misses its target, or nothing tells whether it reaches it
  interrupted = 130  ///< Ctrl-C; the job on the server was cancelled
};

}  // namespace supple::cli
