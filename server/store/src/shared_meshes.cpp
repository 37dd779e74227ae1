#include <utility>

#include "checked_content.h"
#include "file_access.h"
#include "record_file.h"
#include "shared_implementation.h"
#include "supple/base/error.h"

namespace supple::store {
namespace {

constexpr std::chrono::seconds presence_lifetime{1};  // time for which a mesh that the database had counts as stored

[[noreturn]] void throw_no_mesh(const std::string& id) {
  throw Error("mesh.not_found", "There is no mesh " + id + ".");
}

std::string owned_by(const char* parameter) {
  const std::string value(parameter);
  return "(" + value + " = '' OR EXISTS (SELECT 1 FROM mesh_owners WHERE mesh = meshes.id AND owner = " + value + "))";
}

}  // namespace

std::optional<MeshRecord> SharedStore::Implementation::find_mesh(const std::string& id) {
  return database.transaction([&](pqxx::work& transaction) { return find_mesh(transaction, id); });
}

std::optional<MeshRecord> SharedStore::Implementation::find_mesh(pqxx::work& transaction, const std::string& id) {
  const auto rows = transaction.exec_params("SELECT created, description FROM meshes WHERE id = $1", id);
  if (rows.empty()) return std::nullopt;
  return MeshRecord{id, rows[0][0].as<std::int64_t>(), rows[0][1].c_str()};
}

std::pair<MeshRecord, bool> SharedStore::add_mesh(const std::string& ply, const DescribeMesh& describe,
                                                  const std::string& owner) {
  auto& self = *implementation_;
  const auto bytes = static_cast<std::int64_t>(ply.size());
  MeshRecord record;
  record.id = sha256(ply);
  const auto file = self.paths.mesh(record.id);
  if (auto existing = self.find_mesh(record.id)) {
    record = *std::move(existing);
    use_mesh(record.id);
    // Uploading again repairs a file that has been damaged.
    try {
      open_mesh_content(record.id);
    } catch (const Error&) {
      write_stored_file(file, {ply});
    }
    if (!owner.empty() && !owns_mesh(record.id, owner)) self.make_room(Category::meshes, bytes, owner, {});
  } else {
    record.created = now_milliseconds();
    record.description = describe(record.id, record.created);
    self.make_room(Category::meshes, bytes, owner, {});
    write_stored_file(file, {ply});
  }
  bool is_new = false;
  auto added = self.database.transaction([&](pqxx::work& transaction) -> std::pair<MeshRecord, bool> {
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
    auto stored = Implementation::find_mesh(transaction, record.id);
    return {stored ? *std::move(stored) : record, is_new || is_new_owner};
  });
  if (is_new) self.add(Category::meshes, bytes);
  return added;
}

std::optional<MeshRecord> SharedStore::mesh(const std::string& id) const { return implementation_->find_mesh(id); }

std::vector<MeshRecord> SharedStore::meshes(std::size_t limit, const std::string& after,
                                            const std::string& owner) const {
  return implementation_->database.transaction([&](pqxx::work& transaction) {
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

std::string SharedStore::mesh_content(const std::string& id, const CancellationToken& cancellation) const {
  if (!mesh(id)) throw_no_mesh(id);
  try {
    auto bytes = read_file(implementation_->paths.mesh(id), cancellation);
    if (sha256(bytes, cancellation) != id) throw_corrupted(id + ".ply");
    return bytes;
  } catch (const Error& error) {
    if (implementation_->was_removed(error, "meshes", id)) throw_no_mesh(id);
    throw;
  }
}

OpenContent SharedStore::open_mesh_content(const std::string& id, const CancellationToken& cancellation) const {
  if (!mesh(id)) throw_no_mesh(id);
  try {
    return open_checked(implementation_->paths.mesh(id), {}, id, cancellation);
  } catch (const Error& error) {
    if (implementation_->was_removed(error, "meshes", id)) throw_no_mesh(id);
    throw;
  }
}

bool SharedStore::remove_mesh(const std::string& id, const std::string& owner) {
  auto& self = *implementation_;
  std::int64_t freed = 0;
  const bool removed = self.database.transaction([&](pqxx::work& transaction) {
    freed = 0;
    // The row of the mesh is locked, so that two owners who leave at the same time are ordered: the second one is the
    // last.
    const auto rows = transaction.exec_params("SELECT bytes FROM meshes WHERE id = $1 FOR UPDATE", id);
    if (rows.empty()) return false;
    if (!owner.empty()) {
      const auto owners = transaction.exec_params("DELETE FROM mesh_owners WHERE mesh = $1 AND owner = $2", id, owner);
      if (owners.affected_rows() == 0) return false;
      if (!transaction.exec_params("SELECT 1 FROM mesh_owners WHERE mesh = $1 LIMIT 1", id).empty()) return true;
    }
    transaction.exec_params("DELETE FROM meshes WHERE id = $1", id);
    Implementation::remove_file(self.paths.mesh(id));
    freed = rows[0][0].as<std::int64_t>();
    return true;
  });
  self.add(Category::meshes, -freed);
  return removed;
}

bool SharedStore::owns_mesh(const std::string& id, const std::string& owner) const {
  return implementation_->database.transaction([&](pqxx::work& transaction) {
    return !transaction.exec_params("SELECT 1 FROM mesh_owners WHERE mesh = $1 AND owner = $2", id, owner).empty();
  });
}

bool SharedStore::is_last_owner_of_mesh(const std::string& id, const std::string& owner) const {
  return implementation_->database.transaction([&](pqxx::work& transaction) {
    const auto row = transaction.exec_params1(
        "SELECT count(*), count(*) FILTER (WHERE owner = $2) FROM mesh_owners WHERE mesh = $1", id, owner);
    return row[0].as<int>() == 1 && row[1].as<int>() == 1;
  });
}

void SharedStore::use_mesh(const std::string& id) const {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->unwritten_uses[id] = now_milliseconds();
}

std::vector<std::string> SharedStore::remove_unused_meshes(std::int64_t before) {
  auto& self = *implementation_;
  keep_holds({});  // writes the times of use to the database
  return self.database.transaction([&](pqxx::work& transaction) {
    std::vector<std::string> ids;
    const auto rows = transaction.exec_params(
        "DELETE FROM meshes WHERE used < $1 AND NOT EXISTS "
        "(SELECT 1 FROM jobs WHERE jobs.mesh = meshes.id AND finished = 0) RETURNING id",
        before);
    for (const auto& row : rows) ids.emplace_back(row[0].c_str());
    for (const auto& id : ids) Implementation::remove_file(self.paths.mesh(id));
    return ids;
  });
}

bool SharedStore::still_has_mesh(const std::string& id) const {
  auto& self = *implementation_;
  const auto now = Implementation::SteadyClock::now();
  {
    const std::lock_guard lock(self.mutex);
    const auto found = self.confirmed_meshes.find(id);
    if (found != self.confirmed_meshes.end() && now - found->second < presence_lifetime) return true;
  }
  const bool is_stored = self.find_mesh(id).has_value();
  const std::lock_guard lock(self.mutex);
  if (is_stored) {
    self.confirmed_meshes[id] = now;
  } else {
    self.confirmed_meshes.erase(id);
  }
  return is_stored;
}

}  // namespace supple::store
