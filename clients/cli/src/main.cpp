#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <exception>
#include <nlohmann/json.hpp>

#include "exit_code.h"
#include "failure.h"
#include "interrupt.h"
#include "problem_message.h"
#include "program.h"
#include "style.h"
#include "suggestions.h"

namespace {

int run(int argument_count, char** arguments) {
  using supple::cli::ExitCode;
  // Constructed first, so that every later thread leaves Ctrl-C to the watch.
  const supple::cli::InterruptWatch watch;
  supple::cli::GlobalOptions options;
  const auto program = supple::cli::make_program(options);
  try {
    program->parse(argument_count, arguments);
    return static_cast<int>(ExitCode::success);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program->exit(error);
    supple::cli::print_failure(supple::cli::usage_message(*program, error));
    return static_cast<int>(ExitCode::usage);
  } catch (const supple::cli::Problem& problem) {
    supple::cli::print_failure(supple::cli::problem_message(problem, *program));
    return static_cast<int>(problem.code());
  } catch (const supple::cli::Failure& failure) {
    supple::cli::print_failure(failure.what());
    return static_cast<int>(failure.code());
  } catch (const nlohmann::json::exception& error) {
    supple::cli::print_failure(
        fmt::format("the server's answer lacks what this command needs ({}): is its version the same?", error.what()));
    return static_cast<int>(ExitCode::server_error);
  }
}

}  // namespace

int main(int argument_count, char** arguments) {
  try {
    return run(argument_count, arguments);
  } catch (const std::exception& error) {
    supple::cli::print_failure(error.what());
    return static_cast<int>(supple::cli::ExitCode::local_file);
  }
}
