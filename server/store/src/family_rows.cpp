#include "family_rows.h"

#include <sstream>
#include <utility>

#include "file_access.h"
#include "supple/base/error.h"
#include "supple/problem/problem.h"
#include "supple/store/store.h"
#include "supple/store/store_error.h"

namespace supple::store {

std::string hash_of_family(const FamilyRecord& family) {
  return sha256(family.id + "\n" + family.owner + "\n" + family.name + "\n" + std::to_string(family.created) + "\n" +
                family.definition + "\n" + family.description);
}

std::int64_t bytes_of_family(const FamilyRecord& family) {
  return static_cast<std::int64_t>(family.name.size() + family.definition.size() + family.description.size());
}

std::string fault_of_family(const FamilyRecord& family, const std::string& hash) {
  if (hash_of_family(family) == hash) return {};
  return "The row of the family " + family.name + " does not have the content that it was stored with.";
}

void require_sound_family(const FamilyRecord& family, const std::string& hash) {
  if (const auto fault = fault_of_family(family, hash); !fault.empty()) throw StoreCorrupted(fault);
}

bool is_same_family(const FamilyRecord& existing, const FamilyRecord& added) {
  if (existing.definition == added.definition) return true;
  const std::string text = "There is another family of yours with the id " + added.name + " already.";
  throw Error("family.exists", text, {{"/definition/id", text}});
}

void require_room_for_family(std::int64_t count) {
  if (count < FamilyStore::max_families) return;
  problem::throw_limit("family.too_many", "The number of families that a key has",
                       static_cast<double>(FamilyStore::max_families), static_cast<double>(count + 1), "");
}

void throw_family_in_use(const std::string& name) {
  throw Error("family.in_use", "Unfinished jobs need the family " + name + ".");
}

void throw_family_removed() {
  throw Error("tiling.family_not_found", "A family that the job needs was removed while the job was accepted.");
}

void set_family_aside(const DataFolder& folder, const FamilyRecord& family) {
  const auto file = folder.paths().folder / (family.id + ".family");
  write_stored_file(file, {family.definition});
  folder.quarantine(file);
}

std::vector<std::string> family_ids(const JobRecord& job) {
  std::vector<std::string> ids;
  std::istringstream list(job.families);
  for (std::string id; std::getline(list, id, ',');) ids.push_back(std::move(id));
  return ids;
}

}  // namespace supple::store
