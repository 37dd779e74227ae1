#pragma once

#include <CLI/App.hpp>
#include <string>

// Scripts with which a shell completes command lines: commands, options, the values that an option permits, and files.
namespace supple::cli {

std::string bash_completion(const CLI::App& program);
std::string zsh_completion(const CLI::App& program);
std::string fish_completion(const CLI::App& program);

}  // namespace supple::cli
