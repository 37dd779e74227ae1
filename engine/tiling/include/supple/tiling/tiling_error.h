#pragma once

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

}  // namespace supple::tiling
