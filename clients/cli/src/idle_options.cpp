#include "idle_options.h"

#include <fmt/format.h>

#include "failure.h"

namespace supple::cli {

void refuse_idle_options(const CLI::App& command, std::initializer_list<DependentOption> options) {
  for (const DependentOption& option : options) {
    if (option.has_effect || command.count(option.name) == 0) continue;
    throw Failure(ExitCode::usage, fmt::format("{} has no effect {}: leave it out",
                                               command.get_option(option.name)->get_name(), option.where));
  }
}

}  // namespace supple::cli
