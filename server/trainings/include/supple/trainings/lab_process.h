#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/cancellation.h"

namespace supple::trainings {

/// A run of a program, most of all of supple-lab.
struct LabCommand {
  std::string program;                 ///< file of the program
  std::vector<std::string> arguments;  ///< after its name
  std::uint64_t memory = 0;            ///< bytes of address space; 0: no limit
  /// Time after a stop request in which the program may keep what it has done, before it is killed.
  std::chrono::milliseconds grace{10'000};
};

struct LabEnding {
  int status = 0;        ///< exit status; 128 and the number of the signal that ended it
  bool stopped = false;  ///< whether a stop was requested meanwhile
  std::string errors;    ///< the end of what it wrote on stderr, at most 4,000 bytes
};

/// Runs a program to its end, in a process group of its own, and calls `on_line` for each line that it writes on
/// stdout. It has the priority of the thread that starts it. A stop request sends SIGTERM to the group, and SIGKILL
/// after the grace. The program is killed if this process ends, however that ends; a program that has begun meanwhile
/// ends by itself. Throws "training.unavailable" if the program cannot be started. Nothing of the group outlives the
/// call.
LabEnding run_lab(const LabCommand& command, const CancellationToken& cancellation,
                  const std::function<void(std::string_view)>& on_line);

}  // namespace supple::trainings
