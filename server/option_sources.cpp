#include "option_sources.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <ostream>
#include <stdexcept>
#include <string_view>

#include "supple/configuration/config_file.h"
#include "supple/configuration/nearest_name.h"

namespace supple {
namespace {

constexpr std::string_view prefix = "SUPPLE_";

/// Names of variables that the clients, scripts and tests of Supple read, or that Kubernetes sets for a service called
/// supple. A name that ends with "_" stands for all names that begin with it.
constexpr std::array<std::string_view, 16> foreign_names{
    "SUPPLE_CONFIG",  "SUPPLE_SERVER",        "SUPPLE_KEY",      "SUPPLE_KEY_FILE",     "SUPPLE_BUILD", "SUPPLE_JOBS",
    "SUPPLE_CCACHE",  "SUPPLE_SCREENS",       "SUPPLE_EDITOR",   "SUPPLE_FUZZ_SECONDS", "SUPPLE_AVX",   "SUPPLE_TEST_",
    "SUPPLE_RANDOM_", "SUPPLE_SKIP_PACKAGES", "SUPPLE_SERVICE_", "SUPPLE_PORT_"};

bool is_foreign(std::string_view name) {
  return std::any_of(foreign_names.begin(), foreign_names.end(), [&](std::string_view other) {
    return other.back() == '_' ? name.substr(0, other.size()) == other : name == other;
  });
}

std::string variable_of(const std::string& key) {
  std::string name(prefix);
  for (const unsigned char letter : key)
    name += letter == '-' ? '_' : static_cast<char>(std::toupper(static_cast<int>(letter)));
  return name;
}

bool is_given(int argc, char** argv, const std::string& option) {
  return std::any_of(argv + 1, argv + argc, [&](const char* argument) {
    const std::string_view text(argument);
    return text == option || text.substr(0, option.size() + 1) == option + "=";
  });
}

std::vector<std::string> split_at_commas(std::string_view text) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const auto end = std::min(text.find(',', begin), text.size());
    if (end > begin) parts.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') result += '\\';
    result += letter;
  }
  result += '"';
  return result;
}

bool is_number(const std::string& text) {
  if (text.empty()) return false;
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return *end == '\0' && std::isalpha(static_cast<unsigned char>(text.front())) == 0;
}

/// The text of a value as it is written in a configuration file.
std::string as_value(const std::string& text, bool is_flag) { return is_flag || is_number(text) ? text : quoted(text); }

/// The text of a table's cell, in which "|" is escaped because it separates cells.
std::string as_cell(const std::string& text) {
  std::string result;
  for (const char letter : text) {
    if (letter == '|') result += '\\';
    result += letter;
  }
  return result;
}

std::string as_code(const std::string& text) { return '`' + text + '`'; }

}  // namespace

OptionSources::OptionSources(CLI::App& app, int argc, char** argv, std::map<std::string, std::string> computed)
    : computed_(std::move(computed)) {
  const auto add = [&](CLI::Option* option) {
    if (!option->get_configurable() || option->get_lnames().empty()) return;
    Entry entry;
    entry.option = option;
    entry.key = option->get_lnames().front();
    entry.variable = variable_of(entry.key);
    entry.is_flag = option->get_expected_max() == 0;
    entry.is_list = option->get_items_expected_max() > 1;
    entry.default_text = entry.is_flag ? "false" : option->get_default_str();
    entry.on_command_line = is_given(argc, argv, "--" + entry.key);
    entries_.push_back(std::move(entry));
  };
  for (auto* const option : app.get_options()) add(option);
  for (auto* const group : app.get_subcommands([](CLI::App* part) { return part->get_name().empty(); })) {
    for (auto* const option : group->get_options()) add(option);
  }
}

void OptionSources::set(Entry& entry, const std::vector<std::string>& values, const std::string& source) {
  try {
    if (!entry.is_list && values.size() != 1) throw std::runtime_error("--" + entry.key + " has one value, not a list");
    // The library splits a text in brackets into the items of a list.
    std::string text = values.empty() ? std::string() : values.front();
    if (entry.is_list) {
      text = "[";
      for (std::size_t i = 0; i < values.size(); ++i) text.append(i == 0 ? "" : ",").append(values[i]);
      text += ']';
    }
    // An empty list has nothing to parse. The option is empty already.
    if (!entry.is_list || !values.empty()) entry.option->default_val(text);
    entry.source = source;
    entry.values = values;
  } catch (const std::runtime_error& error) {
    faults_.push_back(source + ": " + error.what());
  }
}

void OptionSources::read_file(const std::string& path) {
  configuration::ConfigFile file;
  try {
    file = configuration::read_config_file(path);
  } catch (const std::runtime_error& error) {
    faults_.push_back(std::string("--config: ") + error.what());
    return;
  }
  for (const auto& fault : file.faults) faults_.emplace_back(path).append(", ").append(fault);
  std::vector<std::string> keys;
  for (const auto& entry : entries_) keys.push_back(entry.key);
  for (const auto& setting : file.settings) {
    const auto source = path + ", line " + std::to_string(setting.line);
    const auto entry =
        std::find_if(entries_.begin(), entries_.end(), [&](const auto& other) { return other.key == setting.key; });
    if (entry != entries_.end()) {
      set(*entry, setting.values, source);
      continue;
    }
    auto fault = source + ": there is no key '" + setting.key + "'";
    const auto near = configuration::nearest_name(setting.key, keys);
    fault += near ? "; did you mean '" + *near + "'?" : "; supple-server --help-config lists all of them";
    faults_.push_back(std::move(fault));
  }
}

void OptionSources::read_environment(char** environment) {
  std::vector<std::string> variables;
  for (const auto& entry : entries_) variables.push_back(entry.variable);
  for (; *environment != nullptr; ++environment) {
    const std::string_view line(*environment);
    const auto equals = line.find('=');
    if (line.substr(0, prefix.size()) != prefix || equals == std::string_view::npos) continue;
    const std::string name(line.substr(0, equals));
    const std::string value(line.substr(equals + 1));
    const auto entry =
        std::find_if(entries_.begin(), entries_.end(), [&](const auto& other) { return other.variable == name; });
    if (entry != entries_.end()) {
      // An empty variable counts as not set, because scripts pass on variables that may be empty.
      if (value.empty() || entry->on_command_line) continue;
      const auto before = faults_.size();
      set(*entry, entry->is_list ? split_at_commas(value) : std::vector{value}, "environment, " + name);
      if (faults_.size() > before && entry->key == "port" && value.find("://") != std::string::npos)
        faults_.back() +=
            ". Kubernetes sets this variable for a service with the name supple: say enableServiceLinks: false in the "
            "pod";
    } else if (!is_foreign(name)) {
      auto warning = "the variable " + name + " of the environment is not used: no option has this name";
      if (const auto near = configuration::nearest_name(name, variables)) warning += "; did you mean " + *near + "?";
      warnings_.push_back(std::move(warning));
    }
  }
}

void OptionSources::print_effective(std::ostream& out) const {
  for (const auto& entry : entries_) {
    auto values = entry.values;
    auto source = entry.source;
    if (entry.option->count() > 0) {
      values = entry.option->results();
      source = "command line";
    } else if (values.empty() && !entry.is_list) {
      values = {entry.default_text};
    }
    // A default that is empty means that the option is not set.
    if (!entry.is_list && source == "default" && values.front().empty()) {
      out << "# " << entry.key << " is not set\n";
      continue;
    }
    out << entry.key << " = ";
    if (entry.is_list) {
      out << '[';
      for (std::size_t i = 0; i < values.size(); ++i) out << (i == 0 ? "" : ", ") << quoted(values[i]);
      out << ']';
    } else {
      out << as_value(values.empty() ? std::string() : values.back(), entry.is_flag);
    }
    out << "  # " << source << '\n';
  }
}

void OptionSources::print_table(std::ostream& out) const {
  out << "| Option | Environment | Key of the file | Default | Meaning |\n|---|---|---|---|---|\n";
  for (const auto& entry : entries_) {
    const auto words = computed_.find("--" + entry.key);
    std::string default_text = "none";
    if (words != computed_.end())
      default_text = words->second;
    else if (!entry.is_list && !entry.default_text.empty())
      default_text = as_code(entry.default_text);
    out << "| " << as_code("--" + entry.key) << " | " << as_code(entry.variable) << " | " << as_code(entry.key) << " | "
        << as_cell(default_text) << " | " << as_cell(entry.option->get_description()) << " |\n";
  }
}

std::string config_path(int argc, char** argv) {
  const std::string option = "--config";
  for (int i = 1; i < argc; ++i) {
    const std::string argument(argv[i]);
    if (argument == option) return i + 1 < argc ? argv[i + 1] : "";
    if (argument.substr(0, option.size() + 1) == option + "=") return argument.substr(option.size() + 1);
  }
  const char* const variable = std::getenv("SUPPLE_CONFIG");  // NOLINT(concurrency-mt-unsafe): before any thread starts
  return variable != nullptr ? variable : "";
}

}  // namespace supple
