#include "store_recovery.h"

#include <utility>

#include "supple/json/answers.h"
#include "supple/store/mesh_cache.h"
#include "supple/surface/mesh_io.h"

namespace supple {

store::LocalStore::Recovery recovery_of_store(std::function<void(const std::string&)> warn) {
  store::LocalStore::Recovery recovery;
  recovery.describe = [](const std::string& ply, const std::string& id, std::int64_t created) {
    return json::write_mesh(id, created, surface::report(store::load_stored_mesh(ply)));
  };
  recovery.warn = std::move(warn);
  return recovery;
}

}  // namespace supple
