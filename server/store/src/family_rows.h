#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "data_folder.h"
#include "supple/store/records.h"

namespace supple::store {

/// The columns of a row of "families" that make a family, in the order of its members, and its hash.
inline std::string family_columns() { return "id, owner, name, created, definition, description, hash"; }

/// The hash that a row of "families" has: of all that it says of the family. O(bytes).
std::string hash_of_family(const FamilyRecord& family);

/// Bytes for which a family counts in limits.
std::int64_t bytes_of_family(const FamilyRecord& family);

/// A sentence about a row whose content does not have its hash; empty where it has.
std::string fault_of_family(const FamilyRecord& family, const std::string& hash);

/// A row of "families" that does not have its hash.
struct FaultyFamily {
  FamilyRecord family;
  std::string fault;  ///< a sentence
};

/// Throws "store.corrupted" with this sentence where there is one.
void require_sound_family(const FamilyRecord& family, const std::string& hash);

/// What is to be done with a family of this name, which its owner has already: true where it is the same one. Throws
/// "family.exists" where it is another one.
bool is_same_family(const FamilyRecord& existing, const FamilyRecord& added);

/// Throws "family.too_many" where an owner of `count` families may add none.
void require_room_for_family(std::int64_t count);

[[noreturn]] void throw_family_in_use(const std::string& name);

/// Throws "tiling.family_not_found": the family was there when the request came.
[[noreturn]] void throw_family_removed();

/// Writes what the row of a damaged family has into a file in quarantine.
void set_family_aside(const DataFolder& folder, const FamilyRecord& family);

/// The ids in JobRecord::families.
std::vector<std::string> family_ids(const JobRecord& job);

/// A pattern of LIKE for rows of "jobs" whose column "families" names this id.
inline std::string pattern_of_family(const std::string& id) { return "%" + id + "%"; }

}  // namespace supple::store
