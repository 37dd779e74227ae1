#include "kept_atlases.h"

#include <system_error>
#include <utility>

#include "supple/base/durable_file.h"
#include "supple/base/error.h"
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
  }
  return nullptr;
}

}  // namespace

KeptAtlases::KeptAtlases(std::filesystem::path shipped, std::filesystem::path computed)
    : shipped_(std::move(shipped)), computed_(std::move(computed)) {}

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
  try {
    std::filesystem::create_directories(computed_);
    write_atomically(computed_ / (name + ".json"), {json::write_family_atlas(*record, nullptr, true)});
  } catch (const FileError&) {
  } catch (const std::filesystem::filesystem_error&) {
  }
  const std::scoped_lock lock(mutex_);
  records_[name] = std::move(record);
}

std::vector<KeptAtlases::Record> KeptAtlases::of_families() {
  std::vector<Record> records;
  for (const auto& family : tiling::families())
    if (auto record = find(family.id, family.definition)) records.push_back(std::move(record));
  return records;
}

}  // namespace supple::routes
