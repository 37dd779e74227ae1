#include "replaced_content.h"

#include <system_error>

namespace supple::store {

namespace fs = std::filesystem;

std::vector<fs::path> content_of(const Places& places, const std::set<fs::path>& stays) {
  std::vector<fs::path> content;
  if (!fs::exists(places.folder)) return content;
  for (const auto& entry : fs::directory_iterator(places.folder)) {
    const auto& path = entry.path();
    if (path == places.lock() || path == places.quarantine() || stays.contains(path)) continue;
    if (!entry.is_directory() || !fs::is_empty(path)) content.push_back(path);
  }
  return content;
}

fs::path place_of_replaced(const Places& places) {
  const auto name = compact_time() + "-replaced";
  auto place = places.quarantine() / name;
  for (int i = 1; fs::exists(place); ++i) place = places.quarantine() / (name + "." + std::to_string(i));
  return place;
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
