#include "command_line.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "measurement.h"

namespace supple::bench {
namespace {

int usage(const std::string& program, const std::vector<Option>& options, const std::vector<Study>& studies) {
  std::string line = "usage: " + program;
  for (const Option& option : options)
    line += " [" + option.name + (option.value.empty() ? "" : " " + option.value) + "]";
  if (studies.size() > 1) {
    line += " [STUDY ...]\nstudies:";
    for (const Study& study : studies) line += " " + study.name;
  }
  std::fprintf(stderr, "%s\n", line.c_str());
  return 2;
}

template <class Items>
auto named(const Items& items, const std::string& name) {
  return std::find_if(items.begin(), items.end(), [&](const auto& item) { return item.name == name; });
}

}  // namespace

Option flag(const char* name, bool& value) {
  return {name, "", [&value](const std::string&) { value = true; }};
}
Option number_option(const char* name, int& value) {
  return {name, "N", [&value](const std::string& text) { value = std::atoi(text.c_str()); }};
}
Option folder_option(const char* name, std::filesystem::path& value) {
  return {name, "DIR", [&value](const std::string& text) { value = text; }};
}
Option list_option(const char* name, std::vector<std::string>& values) {
  return {name, "ID", [&values](const std::string& text) { values.push_back(text); }};
}

int run_program(int argc, char** argv, const std::vector<Option>& options, const std::vector<Study>& studies) {
  const std::string program = std::filesystem::path(argv[0]).filename();
  std::vector<Study> wanted;
  for (int i = 1; i < argc; ++i) {
    if (const auto option = named(options, argv[i]); option != options.end()) {
      const bool has_value = !option->value.empty();
      if (has_value && i + 1 == argc) return usage(program, options, studies);
      option->take(has_value ? argv[++i] : "");
    } else if (const auto study = named(studies, argv[i]); study != studies.end()) {
      wanted.push_back(*study);
    } else {
      return usage(program, options, studies);
    }
  }
  try {
    for (const Study& study : wanted.empty() ? studies : wanted) {
      const double start = wall_seconds();
      study.run();
      std::printf("%s: %.0f s\n", study.name.c_str(), wall_seconds() - start);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program.c_str(), error.what());
    return 1;
  }
  return 0;
}

}  // namespace supple::bench
