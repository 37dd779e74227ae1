#pragma once

#include <CLI/App.hpp>
#include <string>

namespace supple::cli {

/// The manual page of the program for section 1, in the man macros of roff: every command with its arguments and
/// options, and the rest of the program's help.
std::string manual_page(const CLI::App& program, const std::string& version);

}  // namespace supple::cli
