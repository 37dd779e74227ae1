#pragma once

#include <functional>
#include <string>

#include "supple/store/local_store.h"

namespace supple {

/// How a store of this server recovers: meshes are described as they are to clients.
store::LocalStore::Recovery recovery_of_store(std::function<void(const std::string&)> warn);

}  // namespace supple
