#include "configuration_check.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>

#include "supple/access/gate.h"

namespace supple {
namespace {

namespace fs = std::filesystem;

bool allowed(const fs::path& path, int mode) { return ::access(path.c_str(), mode) == 0; }

/// The data folder is made at the start where it does not exist yet.
void look_at_data(const std::string& data, std::vector<std::string>& faults) {
  std::error_code error;
  auto existing = fs::absolute(data, error);
  while (!fs::exists(existing, error) && existing.has_relative_path()) existing = existing.parent_path();
  if (!fs::is_directory(existing, error)) {
    faults.push_back("--data: " + existing.string() + " is not a folder");
  } else if (!allowed(existing, W_OK | X_OK)) {
    faults.push_back("--data: " + data + " cannot be written: " + existing.string() + ": " + std::strerror(errno));
  }
}

void look_at_folder(const std::string& option, const std::string& folder, std::vector<std::string>& faults) {
  if (!folder.empty() && !allowed(folder, R_OK | X_OK))
    faults.push_back(option + ": " + folder + " cannot be read: " + std::strerror(errno));
}

}  // namespace

std::vector<std::string> configuration_faults(const ServerOptions& options) {
  std::vector<std::string> faults;
  look_at_data(options.data, faults);
  look_at_folder("--models", options.models, faults);
  look_at_folder("--web", options.web, faults);
  std::error_code error;
  if (!options.web.empty() && !fs::exists(fs::path(options.web) / "index.html", error))
    faults.push_back("--web: " + options.web + " has no index.html: it is not the folder of the built editor");
  if (!options.helper.program.empty() && !allowed(options.helper.program, X_OK))
    faults.push_back("--helper: " + options.helper.program + " cannot be run: " + std::strerror(errno));
  try {
    const access::Gate gate(options.key_file(), options.rule_of_keys());
  } catch (const std::exception& problem) {
    faults.push_back(std::string("--keys: ") + problem.what());
  }
  return faults;
}

}  // namespace supple
