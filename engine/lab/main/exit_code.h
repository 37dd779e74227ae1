#pragma once

namespace supple::lab {

enum class ExitCode {
  success = 0,
  usage = 1,          ///< the command line cannot be understood
  failure = 2,        ///< an error that the message names
  interrupted = 130,  ///< by a signal; the same command goes on
};

}  // namespace supple::lab
