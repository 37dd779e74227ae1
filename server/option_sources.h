#pragma once

#include <CLI/CLI.hpp>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

namespace supple {

/// Where the value of each option comes from. The command line counts most, then the environment, then the
/// configuration file, then the default.
///
/// Every option that can be set has one name in three forms: --max-store, SUPPLE_MAX_STORE and the key max-store.
/// Options that are about the process itself (--help, --config, ...) are those which the library calls not
/// configurable.
class OptionSources {
 public:
  /// The options of `app` and of its groups, as they are with their defaults. `computed` has, by name (--workers), the
  /// words for defaults that depend on the machine. `argv` says which options the command line sets: what the
  /// environment says of those is not looked at.
  OptionSources(CLI::App& app, int argc, char** argv, std::map<std::string, std::string> computed);

  /// What the file says becomes the options' defaults, and so does what the environment says, which is read afterwards.
  /// What cannot be is told by `faults`.
  void read_file(const std::string& path);
  void read_environment(char** environment);

  /// Mistakes that keep the server from starting, each with its place: a key that does not exist, a value out of range.
  const std::vector<std::string>& faults() const { return faults_; }
  /// Variables of the environment whose names begin with SUPPLE_ and which nothing of Supple reads.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// All options in the form of a configuration file, each with the place that its value comes from. Call after the
  /// command line was read.
  void print_effective(std::ostream& out) const;
  /// All options as a table in Markdown, without anything that depends on the machine. Call before anything was read.
  void print_table(std::ostream& out) const;

 private:
  struct Entry {
    CLI::Option* option = nullptr;
    std::string key;       ///< in the file
    std::string variable;  ///< of the environment
    std::string standard;  ///< the default as a text
    bool flag = false;     ///< true or false
    bool list = false;     ///< may be given more than once
    bool on_command_line = false;
    std::string place = "default";
    std::vector<std::string> values;  ///< of the file or the environment
  };

  void set(Entry& entry, const std::vector<std::string>& values, const std::string& place);

  std::vector<Entry> entries_;
  std::map<std::string, std::string> computed_;
  std::vector<std::string> faults_;
  std::vector<std::string> warnings_;
};

/// The file that --config names, else the environment's SUPPLE_CONFIG; empty where there is none.
std::string config_path(int argc, char** argv);

}  // namespace supple
