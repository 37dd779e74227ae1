// A helper process whose tasks do what helpers must not: spin for ever, crash, ask for too much memory.

#include <atomic>
#include <csignal>
#include <stdexcept>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/helper_processes.h"

int main(int argc, char** argv) {
  supple::HelperTasks tasks;
  tasks["echo"] = [](std::string_view request) { return std::string(request); };
  tasks["spin"] = [](std::string_view) -> std::string {
    for (std::atomic<std::uint64_t> turns = 0;; ++turns) {
    }
  };
  tasks["crash"] = [](std::string_view) -> std::string {
    std::signal(SIGSEGV, SIG_DFL);  // sanitizers have a handler of their own
    std::raise(SIGSEGV);
    return {};
  };
  tasks["leave"] = [](std::string_view) -> std::string { std::_Exit(3); };
  tasks["refuse"] = [](std::string_view) -> std::string {
    throw supple::Error("tiling.meshing_failed", "No mesh.", {{"parameters", "are odd"}, {"size", "is even"}});
  };
  tasks["surprise"] = [](std::string_view) -> std::string { throw std::logic_error("a surprise"); };
  tasks["swell"] = [](std::string_view request) {
    // A length that the compiler knows makes clang 14 try it out, and crash.
    return std::string(request.size() + (std::size_t{4} << 30U), 'x');
  };
  return supple::serve_as_helper(argc, argv, tasks);
}
