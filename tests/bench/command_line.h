#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace supple::bench {

/// Something that a benchmark program can measure: its name on the command line and what measures it.
struct Study {
  std::string name;
  std::function<void()> run;
};

/// An option of a command line, with a value unless it is a flag.
struct Option {
  std::string name;   ///< with its dashes
  std::string value;  ///< what stands for the value in the usage line; empty for a flag
  std::function<void(const std::string&)> take;
};
Option flag(const char* name, bool& value);
Option number_option(const char* name, int& value);
Option folder_option(const char* name, std::filesystem::path& value);
/// Adds the value each time it is given.
Option list_option(const char* name, std::vector<std::string>& values);

/// Reads [OPTION ...] [STUDY ...], runs the named studies in this order, or all if none is named, and prints how long
/// each took. Returns the program's exit status: 0, 1 after an exception, which is printed, or 2 after a command line
/// that it does not understand, when it has printed the usage.
int run_program(int argc, char** argv, const std::vector<Option>& options, const std::vector<Study>& studies);

}  // namespace supple::bench
