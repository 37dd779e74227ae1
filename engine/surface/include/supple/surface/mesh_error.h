#pragma once

#include "supple/base/error.h"

namespace supple::surface {

/// A fault of a mesh that a repair removes: "mesh.degenerate_face", "mesh.non_manifold_edge",
/// "mesh.non_manifold_vertex" or "mesh.not_orientable".
class RepairableFault : public Error {
 public:
  using Error::Error;
};

/// A mesh without vertices or faces, or with too many of them: "mesh.empty" or "mesh.too_large".
class MeshSizeError : public Error {
 public:
  using Error::Error;
};

/// A mesh file that does not follow its format ("mesh.malformed").
class MalformedMesh : public Error {
 public:
  using Error::Error;
};

}  // namespace supple::surface
