#include "gmsh_owner.h"

#include <gmsh.h>

#include "supple/base/process_random.h"

namespace supple::meshing {
namespace {

/// Initializes gmsh before the first session, and finalizes it at the end of the process.
class GmshOwner {
 public:
  static GmshOwner& instance() {
    static GmshOwner owner;
    return owner;
  }

  GmshOwner(const GmshOwner&) = delete;
  GmshOwner& operator=(const GmshOwner&) = delete;

  std::unique_lock<std::mutex> lock() { return std::unique_lock(mutex_); }

 private:
  GmshOwner() {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    // gmsh must not throw here: it meshes within parallel regions of OpenMP, where an exception ends the process.
    gmsh::option::setNumber("General.AbortOnError", 0);
    // General.NumThreads would apply to the calling thread only, and to all that this thread runs by OpenMP.
    for (const char* dimension : {"1D", "2D", "3D"}) {
      gmsh::option::setNumber(std::string("Mesh.MaxNumThreads") + dimension, 1);
    }
    gmsh::option::setNumber("Mesh.RandomFactor", 1e-9);
    gmsh::option::setNumber("Mesh.RandomSeed", 1);
    gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
  }
  ~GmshOwner() { gmsh::finalize(); }

  std::mutex mutex_;
};

}  // namespace

GmshSession::GmshSession() {
  GmshOwner& owner = GmshOwner::instance();
  random_lock_ = lock_process_random();
  gmsh_lock_ = owner.lock();
}

GmshModel::GmshModel(const GmshSession& /*session*/) { gmsh::model::add("supple"); }

GmshModel::~GmshModel() {
  gmsh::model::mesh::removeSizeCallback();
  gmsh::model::remove();
}

std::string last_gmsh_error(const GmshSession& /*session*/) {
  std::string last;
  gmsh::logger::getLastError(last);
  return last;
}

}  // namespace supple::meshing
