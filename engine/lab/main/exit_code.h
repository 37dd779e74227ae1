#pragma once

namespace supple::lab {

enum class ExitCode {
  success = 0,
  usage = 1,          ///< the command line cannot be understood
  failure = 2,        ///< an error, which the message describes
  interrupted = 130,  ///< a signal ended the program; the same command continues
};

}  // namespace supple::lab
