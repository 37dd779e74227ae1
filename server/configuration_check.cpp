#include "configuration_check.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "supple/access/gate.h"

namespace supple {
namespace {

namespace fs = std::filesystem;

bool is_accessible(const fs::path& path, int mode) { return ::access(path.c_str(), mode) == 0; }

/// Checks the data folder. If it does not exist, the server makes it at the start, so the nearest
/// existing folder above it must be writable.
void check_data_folder(const std::string& data, std::vector<std::string>& faults) {
  std::error_code error;
  auto existing = fs::absolute(data, error);
  while (!fs::exists(existing, error) && existing.has_relative_path()) existing = existing.parent_path();
  if (!fs::is_directory(existing, error)) {
    faults.push_back("--data: " + existing.string() + " is not a folder");
  } else if (!is_accessible(existing, W_OK | X_OK)) {
    faults.push_back("--data: " + data + " cannot be written: " + existing.string() + ": " + std::strerror(errno));
  }
}

void check_folder(const std::string& option, const std::string& folder, std::vector<std::string>& faults) {
  if (!folder.empty() && !is_accessible(folder, R_OK | X_OK))
    faults.push_back(option + ": " + folder + " cannot be read: " + std::strerror(errno));
}

}  // namespace

std::vector<std::string> configuration_faults(const ServerOptions& options) {
  std::vector<std::string> faults;
  check_data_folder(options.data, faults);
  check_folder("--models", options.models, faults);
  check_folder("--web", options.web, faults);
  std::error_code error;
  if (!options.web.empty() && !fs::exists(fs::path(options.web) / "index.html", error))
    faults.push_back("--web: " + options.web + " has no index.html: it is not the folder of the built editor");
  if (!options.helper.program.empty() && !is_accessible(options.helper.program, X_OK))
    faults.push_back("--helper: " + options.helper.program + " cannot be run: " + std::strerror(errno));
  try {
    const access::Gate gate(options.key_file(), options.rule_of_keys());
  } catch (const std::runtime_error& problem) {
    faults.push_back(std::string("--keys: ") + problem.what());
  }
  return faults;
}

}  // namespace supple
