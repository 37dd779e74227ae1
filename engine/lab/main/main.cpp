// supple-lab: batch work on the engine, without a server.

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <exception>

#include "commands.h"
#include "exit_code.h"
#include "stop_signals.h"
#include "supple/base/error.h"
#include "supple/lab/engine_version.h"

namespace {

using supple::lab::ExitCode;

ExitCode run(int argument_count, char** arguments) {
  const supple::lab::StopSignals signals;
  bool interrupted = false;
  CLI::App program(
      "Batch work on the engine: data sets of families of structures under load, and networks trained on them",
      "supple-lab");
  program.set_version_flag("--version", supple::lab::engine_version());
  program.require_subcommand(1);
  supple::lab::add_commands(program, signals, interrupted);
  try {
    program.parse(argument_count, arguments);
    return interrupted ? ExitCode::interrupted : ExitCode::success;
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? ExitCode::success : ExitCode::usage;
  } catch (const supple::Error& error) {
    fmt::print(stderr, "supple-lab: {} ({})\n", error.what(), error.code());
    for (const auto& detail : error.details()) fmt::print(stderr, "  {}: {}\n", detail.where, detail.message);
    return ExitCode::failure;
  }
}

}  // namespace

int main(int argument_count, char** arguments) {
  try {
    return static_cast<int>(run(argument_count, arguments));
  } catch (const std::exception& error) {
    fmt::print(stderr, "supple-lab: {}\n", error.what());
    return static_cast<int>(ExitCode::failure);
  }
}
