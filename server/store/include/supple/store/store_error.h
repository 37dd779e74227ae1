#pragma once

#include <string>
#include <vector>

#include "supple/base/error.h"

namespace supple::store {

/// The disk of the data folder or of the database is full ("store.full").
class StoreFull : public Error {
 public:
  explicit StoreFull(const std::string& message);
};

/// The disk or the database fails otherwise, or is not one that can be used ("store.unavailable").
class StoreUnavailable : public Error {
 public:
  explicit StoreUnavailable(const std::string& message);
};

/// What was stored is missing, or has changed since it was written ("store.corrupted").
class StoreCorrupted : public Error {
 public:
  explicit StoreCorrupted(const std::string& message);
};

/// There is no mesh of this id ("mesh.not_found").
class MeshNotFound : public Error {
 public:
  explicit MeshNotFound(const std::string& id);
};

/// There is no job of this id ("job.not_found").
class JobNotFound : public Error {
 public:
  explicit JobNotFound(const std::string& id);
};

/// There is no model of this id ("model.not_found"). `known` says which models there are.
class ModelNotFound : public Error {
 public:
  ModelNotFound(const std::string& id, const std::string& known);
};

}  // namespace supple::store
