#pragma once

#include <CLI/CLI.hpp>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

namespace supple {

/// The values of all options and their sources. The command line takes precedence over the environment, this over the
/// configuration file, and this over the default.
///
/// Every option that can be set has one name in three forms: --max-store, SUPPLE_MAX_STORE and the key max-store.
/// Options about the process itself (--help, --config, ...) are excluded; the library CLI11 marks them as not
/// configurable.
class OptionSources {
 public:
  /// Collects the options of `app` and of its groups. `computed` describes in words the defaults that depend on the
  /// machine, by option (--workers). For options that `argv` sets the environment is ignored.
  OptionSources(CLI::App& app, int argc, char** argv, std::map<std::string, std::string> computed);

  /// Makes the values of a configuration file the defaults of the options. Invalid ones are added to `faults`.
  void read_file(const std::string& path);
  /// Does the same for the environment, after `read_file`.
  void read_environment(char** environment);

  /// Errors that keep the server from starting, each with its source: an unknown key, or a value out of range.
  const std::vector<std::string>& faults() const { return faults_; }
  /// Warnings about variables of the environment whose names begin with SUPPLE_, but which no program of Supple reads.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Prints all options in the form of a configuration file, each with the source of its value. Call it after the
  /// command line has been parsed.
  void print_effective(std::ostream& out) const;
  /// Prints all options as a table in Markdown, which does not depend on the machine. Call it before anything is read.
  void print_table(std::ostream& out) const;

 private:
  struct Entry {
    CLI::Option* option = nullptr;
    std::string key;           ///< key in the configuration file
    std::string variable;      ///< name of the environment variable
    std::string default_text;  ///< text of the default
    bool is_flag = false;      ///< whether its value is true or false
    bool is_list = false;      ///< whether it may be given more than once
    bool on_command_line = false;
    std::string source = "default";
    std::vector<std::string> values;  ///< values from the file or the environment
  };

  /// Makes `values` the default of an option; an error is added to `faults_`.
  void set(Entry& entry, const std::vector<std::string>& values, const std::string& source);

  std::vector<Entry> entries_;
  std::map<std::string, std::string> computed_;
  std::vector<std::string> faults_;
  std::vector<std::string> warnings_;
};

/// Path of the configuration file from --config, else from SUPPLE_CONFIG; empty if neither is set.
std::string config_path(int argc, char** argv);

}  // namespace supple
