#include <utility>

#include "checked_content.h"
#include "file_access.h"
#include "record_file.h"
#include "shared_state.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

constexpr std::chrono::seconds presence_lifetime{1};  // time for which a mesh that the database had counts as stored

std::string owned_by(const char* parameter) {
  const std::string value(parameter);
  return "(" + value + " = '' OR EXISTS (SELECT 1 FROM mesh_owners WHERE mesh = meshes.id AND owner = " + value + "))";
}

/// A row and a file for each mesh.
class SharedMeshes final : public MeshStore {
 public:
  explicit SharedMeshes(SharedState& state) : state_(state) {}

  std::pair<MeshRecord, bool> add_mesh(const std::string& ply, const DescribeMesh& describe,
                                       const std::string& owner) override {
    const auto bytes = static_cast<std::int64_t>(ply.size());
    MeshRecord record;
    record.id = sha256(ply);
    const auto file = state_.paths.mesh(record.id);
    if (auto existing = state_.find_mesh(record.id)) {
      record = *std::move(existing);
      note_mesh_use(record.id);
      // Uploading again repairs a file that has been damaged.
      try {
        open_mesh_content(record.id, {});
      } catch (const Error&) {
        write_stored_file(file, {ply});
      }
      if (!owner.empty() && !owns_mesh(record.id, owner)) state_.make_room(Category::meshes, bytes, owner, {});
    } else {
      record.created = now_milliseconds();
      record.description = describe(record.id, record.created);
      state_.make_room(Category::meshes, bytes, owner, {});
      write_stored_file(file, {ply});
    }
    bool is_new = false;
    auto added = state_.database.transaction([&](pqxx::work& transaction) -> std::pair<MeshRecord, bool> {
      // This waits for a server that removes the same mesh, which deletes the file before it commits.
      is_new = transaction
                   .exec_params(
                       "INSERT INTO meshes (id, created, used, bytes, description) VALUES ($1, $2, $2, $3, $4) "
                       "ON CONFLICT (id) DO NOTHING",
                       record.id, record.created, bytes, record.description)
                   .affected_rows() > 0;
      bool is_new_owner = false;
      if (!owner.empty()) {
        is_new_owner = transaction
                           .exec_params("INSERT INTO mesh_owners (mesh, owner) VALUES ($1, $2) ON CONFLICT DO NOTHING",
                                        record.id, owner)
                           .affected_rows() > 0;
      }
      if (bytes_of(file) != bytes) write_stored_file(file, {ply});
      auto stored = SharedState::find_mesh(transaction, record.id);
      return {stored ? *std::move(stored) : record, is_new || is_new_owner};
    });
    if (is_new) state_.add(Category::meshes, bytes);
    return added;
  }

  std::optional<MeshRecord> mesh(const std::string& id) const override { return state_.find_mesh(id); }

  std::vector<MeshRecord> meshes(std::size_t limit, const std::string& after, const std::string& owner) const override {
    return state_.database.transaction([&](pqxx::work& transaction) {
      std::vector<MeshRecord> records;
      const auto rows = transaction.exec_params(
          "SELECT id, created, description FROM meshes WHERE ($1 = '' OR sequence < (SELECT sequence FROM meshes WHERE "
          "id = $1)) AND " +
              owned_by("$3") + " ORDER BY sequence DESC LIMIT $2",
          after, static_cast<std::int64_t>(limit), owner);
      for (const auto& row : rows) records.push_back({row[0].c_str(), row[1].as<std::int64_t>(), row[2].c_str()});
      return records;
    });
  }

  std::string mesh_content(const std::string& id, const CancellationToken& cancellation) const override {
    if (!mesh(id)) throw MeshNotFound(id);
    try {
      auto bytes = read_file(state_.paths.mesh(id), cancellation);
      if (sha256(bytes, cancellation) != id) throw_corrupted(id + ".ply");
      return bytes;
    } catch (const StoreCorrupted&) {
      if (state_.was_removed("meshes", id)) throw MeshNotFound(id);
      throw;
    }
  }

  OpenContent open_mesh_content(const std::string& id, const CancellationToken& cancellation) const override {
    if (!mesh(id)) throw MeshNotFound(id);
    try {
      return open_checked(state_.paths.mesh(id), {}, id, cancellation);
    } catch (const StoreCorrupted&) {
      if (state_.was_removed("meshes", id)) throw MeshNotFound(id);
      throw;
    }
  }

  bool remove_mesh(const std::string& id, const std::string& owner) override {
    std::int64_t freed = 0;
    const bool removed = state_.database.transaction([&](pqxx::work& transaction) {
      freed = 0;
      // The row of the mesh is locked, so that two owners who leave at the same time are ordered: the second one is the
      // last.
      const auto rows = transaction.exec_params("SELECT bytes FROM meshes WHERE id = $1 FOR UPDATE", id);
      if (rows.empty()) return false;
      if (!owner.empty()) {
        const auto owners =
            transaction.exec_params("DELETE FROM mesh_owners WHERE mesh = $1 AND owner = $2", id, owner);
        if (owners.affected_rows() == 0) return false;
        if (!transaction.exec_params("SELECT 1 FROM mesh_owners WHERE mesh = $1 LIMIT 1", id).empty()) return true;
      }
      transaction.exec_params("DELETE FROM meshes WHERE id = $1", id);
      SharedState::remove_file(state_.paths.mesh(id));
      freed = rows[0][0].as<std::int64_t>();
      return true;
    });
    state_.add(Category::meshes, -freed);
    return removed;
  }

  bool owns_mesh(const std::string& id, const std::string& owner) const override {
    return state_.database.transaction([&](pqxx::work& transaction) {
      return !transaction.exec_params("SELECT 1 FROM mesh_owners WHERE mesh = $1 AND owner = $2", id, owner).empty();
    });
  }

  bool is_last_owner_of_mesh(const std::string& id, const std::string& owner) const override {
    return state_.database.transaction([&](pqxx::work& transaction) {
      const auto row = transaction.exec_params1(
          "SELECT count(*), count(*) FILTER (WHERE owner = $2) FROM mesh_owners WHERE mesh = $1", id, owner);
      return row[0].as<int>() == 1 && row[1].as<int>() == 1;
    });
  }

  void note_mesh_use(const std::string& id) const override {
    const std::lock_guard lock(state_.mutex);
    state_.unwritten_uses[id] = now_milliseconds();
  }

  std::vector<std::string> remove_unused_meshes(std::int64_t before) override {
    // A transaction of its own: with the removal in it, two servers might wait for rows that the other one has locked.
    state_.transaction_with_mesh_uses([](pqxx::work&) { return true; });
    std::int64_t freed = 0;
    auto removed = state_.database.transaction([&](pqxx::work& transaction) {
      freed = 0;
      std::vector<std::string> ids;
      const auto rows = transaction.exec_params(
          "DELETE FROM meshes WHERE used < $1 AND NOT EXISTS "
          "(SELECT 1 FROM jobs WHERE jobs.mesh = meshes.id AND finished = 0) RETURNING id, bytes",
          before);
      for (const auto& row : rows) {
        ids.emplace_back(row[0].c_str());
        freed += row[1].as<std::int64_t>();
      }
      for (const auto& id : ids) SharedState::remove_file(state_.paths.mesh(id));
      return ids;
    });
    state_.add(Category::meshes, -freed);
    return removed;
  }

  bool may_have_mesh(const std::string& id) const override {
    const auto now = SharedState::SteadyClock::now();
    {
      const std::lock_guard lock(state_.mutex);
      const auto found = state_.confirmed_meshes.find(id);
      if (found != state_.confirmed_meshes.end() && now - found->second < presence_lifetime) return true;
    }
    const bool is_stored = state_.find_mesh(id).has_value();
    const std::lock_guard lock(state_.mutex);
    if (is_stored) {
      state_.confirmed_meshes[id] = now;
    } else {
      state_.confirmed_meshes.erase(id);
    }
    return is_stored;
  }

 private:
  SharedState& state_;
};

}  // namespace

std::unique_ptr<MeshStore> make_shared_meshes(SharedState& state) { return std::make_unique<SharedMeshes>(state); }

}  // namespace supple::store
