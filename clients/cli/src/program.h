#pragma once

#include <CLI/App.hpp>
#include <memory>

#include "session.h"

namespace supple::cli {

/// The program as it is called: its options, its commands and what is said of them, from which its help, its manual
/// page and the completion of command lines are made. `options` are filled by parsing and must outlive the program.
std::unique_ptr<CLI::App> make_program(GlobalOptions& options);

}  // namespace supple::cli
