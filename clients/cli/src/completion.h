#pragma once

#include <CLI/App.hpp>
#include <string>

// Scripts by which a shell completes command lines: commands, options, values to choose from, and files.
namespace supple::cli {

std::string bash_completion(const CLI::App& program);
std::string zsh_completion(const CLI::App& program);
std::string fish_completion(const CLI::App& program);

}  // namespace supple::cli
