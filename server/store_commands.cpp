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

/// Prints the faults, and a last line with what was done and their number. Returns the exit status.
int print_report(const std::vector<std::string>& faults, const std::string& done) {
  for (const auto& fault : faults) std::cout << fault << '\n';
  std::cout << done << ": " << faults.size() << " faults\n";
  return faults.empty() ? 0 : 1;
}

/// Adds the options --data and --database, which locate a store.
void add_store_options(CLI::App& app, store::SharedStoreLocation& place, const std::string& what) {
  app.option_defaults()->always_capture_default();
  app.add_option("--data", place.folder, what)->envname("SUPPLE_DATA");
  app.add_option("--database", place.database,
                 "PostgreSQL database that several servers share, with the folder --data: "
                 "postgresql://user@host/name; where it is empty, the folder has a database of its own")
      ->envname("SUPPLE_DATABASE");
}

std::string text_of(const store::CopyReport& copy) {
  return std::to_string(copy.files) + " files, " + std::to_string(copy.bytes) + " bytes";
}

}  // namespace

int check_command(int argc, char** argv) {
  store::SharedStoreLocation place{{}, "data"};
  bool repair = false;
  CLI::App app(
      "Looks through a data folder, also while servers use it: the database, and whether every file is there and has "
      "the content that it was stored with.",
      "supple-server check");
  add_store_options(app, place, "Folder of meshes, jobs and results");
  app.get_option("--data")->check(CLI::ExistingDirectory);
  app.add_flag("--repair", repair,
               "Move what is damaged into the folder's quarantine, so that the rest is sound; nothing is deleted. No "
               "server may use the folder meanwhile");
  if (const auto status = parse(app, argc, argv)) return *status;
  const auto log = [](const std::string& text) { std::cout << text << '\n'; };
  const auto problem = [](const std::string& fault) {
    return json::write_problem({"store.corrupted", fault, {}, {}, {}});
  };
  const auto check_or_repair = [&] {
    if (place.database.empty()) {
      return repair ? store::repair_folder(place.folder, recovery_of_store(log), problem)
                    : store::check_folder(place.folder);
    }
    return repair ? store::repair_shared_store(place, log, problem) : store::check_shared_store(place);
  };
  const auto check = check_or_repair();
  return print_report(check.faults, "looked at " + std::to_string(check.families) + " families, " +
                                        std::to_string(check.meshes) + " meshes, " + std::to_string(check.results) +
                                        " results and " + std::to_string(check.requests) + " requests of jobs" +
                                        (repair ? " and repaired" : ""));
}

int backup_command(int argc, char** argv) {
  store::SharedStoreLocation place{{}, "data"};
  std::string to;
  CLI::App app("Copies a data folder as it is at one moment, also while servers use it.", "supple-server backup");
  add_store_options(app, place, "Folder of meshes, jobs and results");
  app.get_option("--data")->check(CLI::ExistingDirectory);
  app.add_option("--to", to, "Folder that becomes the backup; it is empty or does not exist")->required();
  if (const auto status = parse(app, argc, argv)) return *status;
  const auto copy = place.database.empty() ? store::back_up(place.folder, to) : store::back_up_shared_store(place, to);
  return print_report(copy.faults, "backed up " + text_of(copy));
}

int restore_command(int argc, char** argv) {
  store::SharedStoreLocation place{{}, "data"};
  std::string from;
  bool replace = false;
  CLI::App app("Makes a data folder of a backup.", "supple-server restore");
  add_store_options(app, place, "Folder that the server is to use; it is empty or does not exist");
  app.add_option("--from", from, "Folder of the backup")->required()->check(CLI::ExistingDirectory);
  app.add_flag("--replace", replace,
               "Move what is in the data folder, and the rows of the database, into the folder's quarantine instead of "
               "refusing");
  if (const auto status = parse(app, argc, argv)) return *status;
  const auto copy = place.database.empty() ? store::restore(from, place.folder, replace)
                                           : store::restore_shared_store(from, place, replace);
  return print_report(copy.faults, "restored " + text_of(copy));
}

}  // namespace supple
