#include "store_commands.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <optional>
#include <string>

#include "store_recovery.h"
#include "supple/json/answers.h"
#include "supple/store/maintenance.h"

namespace supple {
namespace {

std::optional<int> parse(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
}

/// Prints sentences, then what was done with how many faults. Returns the exit status.
int conclude(const std::vector<std::string>& faults, const std::string& done) {
  for (const auto& fault : faults) std::cout << fault << '\n';
  std::cout << done << ": " << faults.size() << " faults\n";
  return faults.empty() ? 0 : 1;
}

std::string text_of(const store::Copy& copy) {
  return std::to_string(copy.files) + " files, " + std::to_string(copy.bytes) + " bytes";
}

}  // namespace

int check_command(int argc, char** argv) {
  std::string data = "data";
  bool repair = false;
  CLI::App app(
      "Looks through a data folder, also while a server uses it: the database, and whether every file is there and has "
      "the content that it was stored with.",
      "supple-server check");
  app.option_defaults()->always_capture_default();
  app.add_option("--data", data, "Folder of meshes, jobs and results")
      ->envname("SUPPLE_DATA")
      ->check(CLI::ExistingDirectory);
  app.add_flag("--repair", repair,
               "Move what is damaged into the folder's quarantine, so that the rest is sound; nothing is deleted. No "
               "server may use the folder meanwhile");
  if (const auto status = parse(app, argc, argv)) return *status;
  const auto log = [](const std::string& text) { std::cout << text << '\n'; };
  const auto problem = [](const std::string& fault) {
    return json::write_problem({"store.corrupted", fault, {}, {}, {}});
  };
  const auto check = repair ? store::repair_folder(data, recovery_of_store(log), problem) : store::check_folder(data);
  return conclude(check.faults, "looked at " + std::to_string(check.meshes) + " meshes, " +
                                    std::to_string(check.results) + " results and " + std::to_string(check.requests) +
                                    " requests of jobs" + (repair ? " and repaired" : ""));
}

int backup_command(int argc, char** argv) {
  std::string data = "data";
  std::string to;
  CLI::App app("Copies a data folder as it is at one moment, also while a server uses it.", "supple-server backup");
  app.option_defaults()->always_capture_default();
  app.add_option("--data", data, "Folder of meshes, jobs and results")
      ->envname("SUPPLE_DATA")
      ->check(CLI::ExistingDirectory);
  app.add_option("--to", to, "Folder that becomes the backup; it is empty or does not exist")->required();
  if (const auto status = parse(app, argc, argv)) return *status;
  const auto copy = store::back_up(data, to);
  return conclude(copy.faults, "backed up " + text_of(copy));
}

int restore_command(int argc, char** argv) {
  std::string data = "data";
  std::string from;
  bool replace = false;
  CLI::App app("Makes a data folder of a backup.", "supple-server restore");
  app.option_defaults()->always_capture_default();
  app.add_option("--from", from, "Folder of the backup")->required()->check(CLI::ExistingDirectory);
  app.add_option("--data", data, "Folder that the server is to use; it is empty or does not exist")
      ->envname("SUPPLE_DATA");
  app.add_flag("--replace", replace, "Move what is in the data folder into its quarantine instead of refusing");
  if (const auto status = parse(app, argc, argv)) return *status;
  const auto copy = store::restore(from, data, replace);
  return conclude(copy.faults, "restored " + text_of(copy));
}

}  // namespace supple
