#include <utility>

#include "shared_schema.h"
#include "shared_state.h"

namespace supple::store {
namespace {

/// A row for each family.
class SharedFamilies final : public FamilyStore {
 public:
  explicit SharedFamilies(SharedState& state) : state_(state) {}

  std::pair<FamilyRecord, bool> add_family(FamilyRecord given) override {
    if (auto existing = family(given.owner, given.name); existing && is_same_family(*existing, given))
      return {*std::move(existing), false};
    state_.database.transaction([&](pqxx::work& transaction) { return require_room(transaction, given.owner); });
    state_.make_room(Category::families, bytes_of_family(given), given.owner, {});
    const bool is_new = state_.database.transaction([&](pqxx::work& transaction) {
      // Requests of one owner at several servers are counted one after the other.
      transaction.exec_params("SELECT pg_advisory_xact_lock(hashtextextended($1, 0))", "families of " + given.owner);
      require_room(transaction, given.owner);
      return insert_shared_family(transaction, given, hash_of_family(given));
    });
    if (is_new) return {std::move(given), true};
    // Another server has added one of this name meanwhile.
    auto existing = family(given.owner, given.name);
    if (!existing) return add_family(std::move(given));  // and it was removed again
    is_same_family(*existing, given);
    return {*std::move(existing), false};
  }

  std::optional<FamilyRecord> family(const std::string& owner, const std::string& name) const override {
    return state_.database.transaction([&](pqxx::work& transaction) -> std::optional<FamilyRecord> {
      const auto rows = transaction.exec_params(
          "SELECT " + family_columns() + " FROM families WHERE owner = $1 AND name = $2", owner, name);
      if (rows.empty()) return std::nullopt;
      auto found = read_shared_family(rows[0]);
      require_sound_family(found, rows[0][6].c_str());
      return found;
    });
  }

  std::vector<FamilyRecord> families(const std::string& owner) const override {
    return state_.database.transaction([&](pqxx::work& transaction) {
      std::vector<FamilyRecord> records;
      for (const auto& row : transaction.exec_params(
               "SELECT " + family_columns() + " FROM families WHERE owner = $1 ORDER BY sequence", owner))
        records.push_back(read_shared_family(row));
      return records;
    });
  }

  bool remove_family(const std::string& owner, const std::string& name) override {
    return state_.database.transaction([&](pqxx::work& transaction) {
      // The row is locked, so that no server adds a job that needs the family.
      const auto rows =
          transaction.exec_params("SELECT id FROM families WHERE owner = $1 AND name = $2 FOR UPDATE", owner, name);
      if (rows.empty()) return false;
      const std::string id = rows[0][0].c_str();
      const auto jobs = transaction.exec_params("SELECT 1 FROM jobs WHERE finished = 0 AND families LIKE $1 LIMIT 1",
                                                pattern_of_family(id));
      if (!jobs.empty()) throw_family_in_use(name);
      transaction.exec_params("DELETE FROM families WHERE id = $1", id);
      return true;
    });
  }

 private:
  /// Throws "family.too_many". Otherwise true.
  static bool require_room(pqxx::work& transaction, const std::string& owner) {
    const auto row = transaction.exec_params1("SELECT count(*) FROM families WHERE owner = $1", owner);
    require_room_for_family(row[0].as<std::int64_t>());
    return true;
  }

  SharedState& state_;
};

}  // namespace

std::unique_ptr<FamilyStore> make_shared_families(SharedState& state) {
  return std::make_unique<SharedFamilies>(state);
}

}  // namespace supple::store
