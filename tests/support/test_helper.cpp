// A helper process whose tasks do what helpers must not do: loop for ever, crash, request too much memory.

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
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
  tasks["spin for a second"] = [&tasks](std::string_view request) {
    supple::limit_cpu_time(std::chrono::seconds(1));
    return tasks["spin"](request);
  };
  tasks["crash"] = [](std::string_view) -> std::string {
    std::signal(SIGSEGV, SIG_DFL);  // removes the handler of a sanitizer
    std::raise(SIGSEGV);
    return {};
  };
  tasks["leave"] = [](std::string_view) -> std::string { std::_Exit(3); };
  tasks["leave without a word"] = [](std::string_view) -> std::string { std::_Exit(0); };
  tasks["remember"] = [](std::string_view request) {
    // State that earlier tasks leave in the process: their number, and the effect of freed memory on addresses.
    static std::vector<std::string> before;
    before.emplace_back(request);
    const auto here = std::make_unique<std::array<char, 100>>();
    before.resize(before.size() + request.size() % 7);
    return std::to_string(before.size()) + " " + std::to_string(reinterpret_cast<std::uintptr_t>(here->data()));
  };
  tasks["refuse"] = [](std::string_view) -> std::string {
    throw supple::Error("tiling.meshing_failed", "No mesh.", {{"parameters", "are odd"}, {"size", "is even"}});
  };
  tasks["surprise"] = [](std::string_view) -> std::string { throw std::logic_error("a surprise"); };
  tasks["swell"] = [](std::string_view request) {
    // With a constant length, clang 14 would evaluate this at compile time, and crash.
    return std::string(request.size() + (std::size_t{4} << 30U), 'x');
  };
  return supple::serve_as_helper(argc, argv, tasks);
}
