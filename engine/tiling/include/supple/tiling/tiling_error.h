#pragma once

#include <string>

#include "supple/base/error.h"

namespace supple::tiling {

/// A structure or part that cannot be built, meshed or written as it was asked for. Its code begins with "tiling.".
class TilingError : public Error {
 public:
  using Error::Error;
};

/// There is no family of this id ("tiling.family_not_found").
class FamilyNotFound : public TilingError {
 public:
  using TilingError::TilingError;
};

/// A part that cannot be made or written ("tiling.part").
class PartError : public TilingError {
 public:
  using TilingError::TilingError;
};

/// Options with which no mesh is made: "tiling.mesh_option" or "tiling.mesh_too_large".
class MeshOptionError : public TilingError {
 public:
  using TilingError::TilingError;
};

/// A mesh would have more nodes than its options allow ("tiling.mesh_too_large").
class MeshTooLarge : public MeshOptionError {
 public:
  using MeshOptionError::MeshOptionError;
};

/// Throws an error whose code begins with "tiling." as the type that belongs to its code.
[[noreturn]] inline void throw_typed(const Error& error) {
  const std::string& code = error.code();
  if (code == "tiling.family_not_found") throw FamilyNotFound(code, error.what(), error.details());
  if (code == "tiling.part") throw PartError(code, error.what(), error.details());
  if (code == "tiling.mesh_too_large") throw MeshTooLarge(code, error.what(), error.details());
  if (code == "tiling.mesh_option") throw MeshOptionError(code, error.what(), error.details());
  throw TilingError(code, error.what(), error.details());
}

}  // namespace supple::tiling
