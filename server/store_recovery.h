#pragma once

#include <functional>
#include <string>

#include "supple/store/local_store.h"

namespace supple {

/// Settings with which a store recovers lost rows: meshes get the same description in JSON that clients get. `warn`
/// gets lines for the log.
store::LocalStore::Recovery recovery_of_store(std::function<void(const std::string&)> warn);

}  // namespace supple
