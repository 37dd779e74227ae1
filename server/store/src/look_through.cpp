#include "look_through.h"

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

void count(const StoredFile& file, Check& check) {
  ++(file.kind == Kind::mesh ? check.meshes : file.kind == Kind::result ? check.results : check.requests);
}

/// What a server adds or removes at the moment is there before its row is, or after it: that is looked at twice.
void find_unknown(const Places& places, const Catalogue& catalogue, const std::set<fs::path>& known, Check& check) {
  const auto first = unknown_files(places, catalogue.names, known);
  if (first.empty()) return;
  constexpr std::chrono::milliseconds between_file_and_row{500};
  std::this_thread::sleep_for(between_file_and_row);
  const auto second = unknown_files(places, catalogue.names, known);
  for (const auto& path : first) {
    if (std::find(second.begin(), second.end(), path) == second.end()) continue;
    check.faults.push_back("The database does not name the file " + path.filename().string() + ".");
  }
}

}  // namespace

std::string fault_on_disk(const StoredFile& file, const Places& places) {
  const auto path = file.place(places);
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

std::vector<fs::path> unknown_files(const Places& places, const std::function<bool(const StoredFile&)>& names,
                                    const std::set<fs::path>& known) {
  std::vector<fs::path> unknown;
  for (const auto& [kind, folder, suffix] :
       {std::tuple(Kind::mesh, places.meshes(), ".ply"), std::tuple(Kind::result, places.results(), ".result"),
        std::tuple(Kind::request, places.requests(), ".request")}) {
    if (!fs::exists(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder)) {
      const auto& path = entry.path();
      if (is_unfinished(path) || known.contains(path)) continue;
      if (path.extension() != suffix || !names({kind, path.stem().string(), {}})) unknown.push_back(path);
    }
  }
  return unknown;
}

void look_through(const Places& places, const Catalogue& catalogue, Check& check) {
  std::set<fs::path> known;
  for (const auto& file : catalogue.files()) {
    known.insert(file.place(places));
    auto fault = fault_on_disk(file, places);
    // What has gone meanwhile is no fault; nor is what a repair by a client has put right.
    if (!fault.empty()) fault = catalogue.names(file) ? fault_on_disk(file, places) : std::string();
    if (!fault.empty() && !catalogue.names(file)) continue;
    count(file, check);
    if (!fault.empty()) check.faults.push_back(std::move(fault));
  }
  find_unknown(places, catalogue, known, check);
}

}  // namespace supple::store
