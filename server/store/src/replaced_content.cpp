#include "replaced_content.h"

#include <system_error>

namespace supple::store {

namespace fs = std::filesystem;

std::vector<fs::path> content_of(const DataPaths& paths, const std::set<fs::path>& excluded) {
  std::vector<fs::path> content;
  if (!fs::exists(paths.folder)) return content;
  for (const auto& entry : fs::directory_iterator(paths.folder)) {
    const auto& path = entry.path();
    if (path == paths.lock() || path == paths.quarantine() || excluded.contains(path)) continue;
    if (!entry.is_directory() || !fs::is_empty(path)) content.push_back(path);
  }
  return content;
}

fs::path quarantine_folder_of_replaced(const DataPaths& paths) {
  const auto name = compact_time() + "-replaced";
  auto folder = paths.quarantine() / name;
  for (int i = 1; fs::exists(folder); ++i) folder = paths.quarantine() / (name + "." + std::to_string(i));
  return folder;
}

void Moves::move(const fs::path& from, const fs::path& to) {
  fs::create_directories(to.parent_path());
  if (fs::is_directory(to)) fs::remove(to);
  fs::rename(from, to);
  done_.emplace_back(from, to);
}

void Moves::undo() noexcept {
  std::error_code ignored;
  for (auto move = done_.rbegin(); move != done_.rend(); ++move) fs::rename(move->second, move->first, ignored);
  done_.clear();
}

}  // namespace supple::store
