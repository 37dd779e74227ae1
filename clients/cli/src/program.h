#pragma once

#include <CLI/App.hpp>
#include <memory>

#include "session.h"

namespace supple::cli {

/// The program with its options, its commands and their descriptions, from which its help, its manual page and the
/// completion scripts are made. Parsing fills `options`, which must outlive the program.
std::unique_ptr<CLI::App> make_program(GlobalOptions& options);

}  // namespace supple::cli
