#include "file_check.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <tuple>
#include <utility>

#include "file_access.h"
#include "supple/base/error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;
using Kind = StoredFile::Kind;

void count(const StoredFile& file, CheckReport& check) {
  ++(file.kind == Kind::mesh ? check.meshes : file.kind == Kind::result ? check.results : check.requests);
}

/// While a server adds or removes a file, the file may exist without its row for a moment. Therefore only files that
/// have no row in two scans count.
void find_orphans(const DataPaths& paths, const Catalogue& catalogue, const std::set<fs::path>& named,
                  CheckReport& check) {
  const auto first = orphaned_files(paths, catalogue.contains, named);
  if (first.empty()) return;
  constexpr std::chrono::milliseconds between_file_and_row{500};
  std::this_thread::sleep_for(between_file_and_row);
  const auto second = orphaned_files(paths, catalogue.contains, named);
  for (const auto& path : first) {
    if (std::find(second.begin(), second.end(), path) == second.end()) continue;
    check.faults.push_back("The database does not name the file " + path.filename().string() + ".");
  }
}

}  // namespace

std::string fault_on_disk(const StoredFile& file, const DataPaths& paths) {
  const auto path = file.path(paths);
  const auto name = path.filename().string();
  try {
    const auto content = read_file(path);
    auto fault = fault_of(file, name, content);
    const auto bytes = static_cast<std::int64_t>(content.size());
    if (fault.empty() && file.bytes >= 0 && file.bytes != bytes) {
      fault = "The database says that the file " + name + " has " + std::to_string(file.bytes) + " bytes; it has " +
              std::to_string(bytes) + ".";
    }
    return fault;
  } catch (const Error& error) {
    return error.what();
  }
}

std::vector<fs::path> orphaned_files(const DataPaths& paths, const std::function<bool(const StoredFile&)>& is_named,
                                     const std::set<fs::path>& named) {
  std::vector<fs::path> unknown;
  for (const auto& [kind, folder, suffix] :
       {std::tuple(Kind::mesh, paths.meshes(), ".ply"), std::tuple(Kind::result, paths.results(), ".result"),
        std::tuple(Kind::request, paths.requests(), ".request")}) {
    if (!fs::exists(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder)) {
      const auto& path = entry.path();
      if (is_unfinished(path) || named.contains(path)) continue;
      if (path.extension() != suffix || !is_named({kind, path.stem().string(), {}})) unknown.push_back(path);
    }
  }
  return unknown;
}

void check_files(const DataPaths& paths, const Catalogue& catalogue, CheckReport& check) {
  std::set<fs::path> named;
  for (const auto& file : catalogue.files()) {
    named.insert(file.path(paths));
    auto fault = fault_on_disk(file, paths);
    // A file that was removed meanwhile is no fault, and neither is one that a client has repaired by uploading it
    // again.
    if (!fault.empty()) fault = catalogue.contains(file) ? fault_on_disk(file, paths) : std::string();
    if (!fault.empty() && !catalogue.contains(file)) continue;
    count(file, check);
    if (!fault.empty()) check.faults.push_back(std::move(fault));
  }
  find_orphans(paths, catalogue, named, check);
}

}  // namespace supple::store
