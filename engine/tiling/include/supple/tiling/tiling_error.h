#pragma once

#include "supple/base/error.h"

namespace supple::tiling {

/// A structure or part that cannot be built, meshed or written as it was asked for. Its code begins with "tiling.".
class TilingError : public Error {
 public:
  using Error::Error;
};

/// A mesh would have more nodes than its options allow ("tiling.mesh_too_large").
class MeshTooLarge : public TilingError {
 public:
  using TilingError::TilingError;
};

}  // namespace supple::tiling
