#include <algorithm>
#include <utility>

#include "local_state.h"

namespace supple::store {
namespace {

/// A row for each family.
class LocalFamilies final : public FamilyStore {
 public:
  explicit LocalFamilies(LocalState& state) : state_(state) {}

  std::pair<FamilyRecord, bool> add_family(FamilyRecord family) override {
    const auto limit = state_.limit_of(family.owner);
    const auto bytes = bytes_of_family(family);
    {
      const std::lock_guard lock(state_.mutex);
      if (auto existing = find(family.owner, family.name); existing && is_same_family(*existing, family))
        return {*std::move(existing), false};
      require_room(family, limit, bytes);
    }
    // The bytes are claimed while the row is written; from then on they are part of the database's.
    state_.claim_space(Category::families, bytes);
    const SpaceClaim claim(state_.usage_counter, Category::families, bytes);
    const std::lock_guard lock(state_.mutex);
    if (auto existing = find(family.owner, family.name); existing && is_same_family(*existing, family))
      return {*std::move(existing), false};
    require_room(family, limit, bytes);
    insert_family(state_.database, family, hash_of_family(family));
    return {std::move(family), true};
  }

  std::optional<FamilyRecord> family(const std::string& owner, const std::string& name) const override {
    const std::lock_guard lock(state_.mutex);
    return find(owner, name);
  }

  std::vector<FamilyRecord> families(const std::string& owner) const override {
    const std::lock_guard lock(state_.mutex);
    std::vector<FamilyRecord> records;
    Statement rows(state_.database, "SELECT " + family_columns() + " FROM families WHERE owner = ? ORDER BY sequence");
    for (rows.bind(owner); rows.step();) records.push_back(read_family(rows));
    return records;
  }

  bool remove_family(const std::string& owner, const std::string& name) override {
    const std::lock_guard lock(state_.mutex);
    std::string id;
    {
      Statement row(state_.database, "SELECT id FROM families WHERE owner = ? AND name = ?");
      if (!row.bind(owner).bind(name).step()) return false;
      id = row.text(0);
    }
    {
      Statement jobs(state_.database, "SELECT 1 FROM jobs WHERE finished = 0 AND families LIKE ? LIMIT 1");
      if (jobs.bind(pattern_of_family(id)).step()) throw_family_in_use(name);
    }
    state_.with_reserve([&] { return Statement(state_.database, "DELETE FROM families WHERE id = ?").bind(id).run(); });
    state_.reserve.refill();
    return true;
  }

 private:
  /// Requires the mutex.
  std::optional<FamilyRecord> find(const std::string& owner, const std::string& name) const {
    Statement row(state_.database, "SELECT " + family_columns() + " FROM families WHERE owner = ? AND name = ?");
    if (!row.bind(owner).bind(name).step()) return std::nullopt;
    auto family = read_family(row);
    require_sound_family(family, row.text(6));
    return family;
  }

  /// Requires the mutex.
  void require_room(const FamilyRecord& family, std::int64_t limit, std::int64_t bytes) {
    Statement count(state_.database, "SELECT COUNT(*) FROM families WHERE owner = ?");
    if (count.bind(family.owner).step()) require_room_for_family(count.integer(0));
    state_.make_room_within_owner_limit(family.owner, limit, Category::families, bytes);
  }

  LocalState& state_;
};

}  // namespace

std::unique_ptr<FamilyStore> make_local_families(LocalState& state) { return std::make_unique<LocalFamilies>(state); }

}  // namespace supple::store
