#include <utility>

#include "checked_content.h"
#include "local_state.h"
#include "record_file.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

/// A row and a file for each mesh.
class LocalMeshes final : public MeshStore {
 public:
  explicit LocalMeshes(LocalState& state) : state_(state) {}

  std::pair<MeshRecord, bool> add_mesh(const std::string& ply, const DescribeMesh& describe,
                                       const std::string& owner) override {
    const auto bytes = static_cast<std::int64_t>(ply.size());
    const auto limit = state_.limit_of(owner);
    MeshRecord record;
    record.id = sha256(ply);
    if (mesh(record.id)) {
      note_mesh_use(record.id);
      // Uploading again repairs a file that has been damaged.
      try {
        open_mesh_content(record.id, {});
      } catch (const Error&) {
        repair_file(record.id, ply);
      }
      const std::lock_guard lock(state_.mutex);
      if (auto existing = state_.find_mesh(record.id))
        return {std::move(*existing), state_.add_owner_of_mesh(record.id, owner, limit, bytes)};
      // The last owner has removed the mesh meanwhile, so that it is a new one.
    }
    record.created = now_milliseconds();
    record.description = describe(record.id, record.created);
    {
      const std::lock_guard lock(state_.mutex);  // checks the owner's limit before results of others expire
      state_.make_room_within_owner_limit(owner, limit, Category::meshes, bytes);
    }
    state_.claim_space(Category::meshes, bytes);
    SpaceClaim claim(state_.usage_counter, Category::meshes, bytes);
    // The mutex is held from here on, so that the mesh cannot be removed between writing its file and its row.
    const std::lock_guard lock(state_.mutex);
    if (auto existing = state_.find_mesh(record.id))
      return {std::move(*existing), state_.add_owner_of_mesh(record.id, owner, limit, bytes)};
    state_.make_room_within_owner_limit(owner, limit, Category::meshes, bytes);
    write_stored_file(state_.paths.mesh(record.id), {ply});
    try {
      Transaction transaction(state_.database);
      insert_mesh(state_.database, record, bytes);
      if (!owner.empty()) state_.owners.add(OwnerTable::Kind::mesh, record.id, owner);
      transaction.commit();
    } catch (...) {
      std::error_code ignored;
      std::filesystem::remove(state_.paths.mesh(record.id), ignored);
      throw;
    }
    claim.commit();
    return {std::move(record), true};
  }

  std::optional<MeshRecord> mesh(const std::string& id) const override {
    const std::lock_guard lock(state_.mutex);
    return state_.find_mesh(id);
  }

  std::vector<MeshRecord> meshes(std::size_t limit, const std::string& after, const std::string& owner) const override {
    const std::lock_guard lock(state_.mutex);
    std::vector<MeshRecord> records;
    Statement rows(state_.database,
                   "SELECT id, created, description FROM meshes WHERE (?1 = '' OR sequence < "
                   "(SELECT sequence FROM meshes WHERE id = ?1)) AND " +
                       OwnerTable::condition(OwnerTable::Kind::mesh, "?3") + " ORDER BY sequence DESC LIMIT ?2");
    rows.bind(after).bind(static_cast<std::int64_t>(limit)).bind(owner);
    while (rows.step()) records.push_back({rows.text(0), rows.integer(1), rows.text(2)});
    return records;
  }

  std::string mesh_content(const std::string& id, const CancellationToken& cancellation) const override {
    if (!mesh(id)) throw MeshNotFound(id);
    auto bytes = read_file(state_.paths.mesh(id), cancellation);
    if (sha256(bytes, cancellation) != id) throw_corrupted(id + ".ply");
    return bytes;
  }

  OpenContent open_mesh_content(const std::string& id, const CancellationToken& cancellation) const override {
    if (!mesh(id)) throw MeshNotFound(id);
    return open_checked(state_.paths.mesh(id), {}, id, cancellation);
  }

  bool remove_mesh(const std::string& id, const std::string& owner) override {
    const std::lock_guard lock(state_.mutex);
    if (!owner.empty()) {
      if (!state_.owners.has(OwnerTable::Kind::mesh, id, owner)) return false;
      if (state_.owners.count(OwnerTable::Kind::mesh, id) > 1)
        return state_.owners.remove(OwnerTable::Kind::mesh, id, owner);
    }
    const int rows = state_.with_reserve(
        [&] { return Statement(state_.database, "DELETE FROM meshes WHERE id = ?").bind(id).run(); });
    if (rows == 0) return false;
    state_.delete_file(Category::meshes, state_.paths.mesh(id));  // if it stays, the next start makes a row for it
    state_.reserve.refill();
    return true;
  }

  bool owns_mesh(const std::string& id, const std::string& owner) const override {
    const std::lock_guard lock(state_.mutex);
    return state_.owners.has(OwnerTable::Kind::mesh, id, owner);
  }

  bool is_last_owner_of_mesh(const std::string& id, const std::string& owner) const override {
    const std::lock_guard lock(state_.mutex);
    const auto& owners = state_.owners;
    return owners.has(OwnerTable::Kind::mesh, id, owner) && owners.count(OwnerTable::Kind::mesh, id) == 1;
  }

  void note_mesh_use(const std::string& id) const override {
    const std::lock_guard lock(state_.uses_mutex);
    state_.unwritten_uses[id] = now_milliseconds();
  }

  std::vector<std::string> remove_unused_meshes(std::int64_t before) override {
    std::vector<std::string> ids;
    const std::scoped_lock lock(state_.mutex, state_.uses_mutex);
    state_.with_reserve([&] { state_.write_mesh_uses(); });
    {
      Statement rows(state_.database,
                     "SELECT id FROM meshes WHERE max(created, used) < ? AND id NOT IN "
                     "(SELECT mesh FROM jobs WHERE finished = 0)");
      for (rows.bind(before); rows.step();) ids.push_back(rows.text(0));
    }
    for (const auto& id : ids) {
      state_.with_reserve([&] { Statement(state_.database, "DELETE FROM meshes WHERE id = ?").bind(id).run(); });
      state_.delete_file(Category::meshes, state_.paths.mesh(id));
    }
    state_.reserve.refill();
    return ids;
  }

 private:
  /// Replaces the damaged or missing file of a mesh, unless the mesh has been removed meanwhile.
  void repair_file(const std::string& id, const std::string& ply) {
    const std::lock_guard lock(state_.mutex);
    if (!state_.find_mesh(id)) return;
    write_stored_file(state_.paths.mesh(id), {ply});
    state_.usage_counter.count();  // recounts, for the damaged file may have had another size
  }

  LocalState& state_;
};

}  // namespace

std::unique_ptr<MeshStore> make_local_meshes(LocalState& state) { return std::make_unique<LocalMeshes>(state); }

}  // namespace supple::store
