#include "kept_atlases.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "supple/base/durable_file.h"
#include "supple/base/error.h"
#include "supple/json/family_definitions.h"
#include "supple/store/store.h"
#include "supple/tiling/family.h"

namespace supple::routes {
namespace {

KeptAtlases::Record read_record(const std::filesystem::path& folder, const std::string& name,
                                const KeptAtlases::Definition& definition) {
  const auto path = folder / (name + ".json");
  std::error_code error;
  if (folder.empty() || !std::filesystem::is_regular_file(path, error)) return nullptr;
  try {
    if (auto record = json::read_family_atlas(content_of(path), definition))
      return std::make_shared<const json::AtlasRecord>(std::move(*record));
  } catch (const Error&) {
    // A file that cannot be read counts as none, and is computed anew.
  } catch (const FileError&) {
    // So does one that somebody removes meanwhile.
  }
  return nullptr;
}

/// Writes the file of an atlas. One that cannot be written is left out.
void write_record(const std::filesystem::path& folder, const std::string& name, const json::AtlasRecord& record) {
  try {
    std::filesystem::create_directories(folder);
    write_atomically(folder / (name + ".json"), {json::write_family_atlas(record, nullptr, true)});
  } catch (const FileError&) {
  } catch (const std::filesystem::filesystem_error&) {
  }
}

std::string hash_of(const tiling::FamilyDefinition& definition) {
  return store::sha256(json::write_family_definition(definition));
}

/// Removes the files of a folder that were written first, so that `max` are left.
void keep_newest(const std::filesystem::path& folder, std::size_t max) {
  std::error_code error;
  std::vector<std::pair<std::filesystem::file_time_type, std::filesystem::path>> files;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code is_gone;
    const auto written = entry->last_write_time(is_gone);
    if (!is_gone) files.emplace_back(written, entry->path());
  }
  if (files.size() <= max) return;
  std::sort(files.begin(), files.end());
  files.resize(files.size() - max);
  for (const auto& [written, path] : files) std::filesystem::remove(path, error);
}

}  // namespace

KeptAtlases::KeptAtlases(std::filesystem::path shipped, std::filesystem::path computed)
    : shipped_(std::move(shipped)), computed_(std::move(computed)), added_(computed_ / "added") {}

KeptAtlases::Record KeptAtlases::find(const std::string& name, const Definition& definition) {
  const std::scoped_lock lock(mutex_);
  const auto found = records_.find(name);
  if (found != records_.end()) return found->second;
  auto record = read_record(computed_, name, definition);
  if (!record) record = read_record(shipped_, name, definition);
  records_[name] = record;
  return record;
}

void KeptAtlases::keep(const std::string& name, Record record) {
  write_record(computed_, name, *record);
  const std::scoped_lock lock(mutex_);
  records_[name] = std::move(record);
}

KeptAtlases::Record KeptAtlases::find_added(const Definition& definition) const {
  return read_record(added_, hash_of(*definition), definition);
}

void KeptAtlases::keep_added(const json::AtlasRecord& record) {
  const std::scoped_lock lock(mutex_);
  write_record(added_, hash_of(*record.definition), record);
  keep_newest(added_, max_added);
}

std::vector<KeptAtlases::Record> KeptAtlases::of_families() {
  std::vector<Record> records;
  for (const auto& family : tiling::families())
    if (auto record = find(family.id, family.definition)) records.push_back(std::move(record));
  return records;
}

}  // namespace supple::routes
