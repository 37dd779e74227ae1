#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "supple/surface/geodesic_solver.h"
#include "window_search.h"

namespace supple::surface {

struct GeodesicSolver::Implementation {
  Implementation(std::shared_ptr<const TriangleMesh> mesh, const Execution& execution)
      : search_mesh(std::make_shared<const SearchMesh>(std::move(mesh), execution)) {}

  std::shared_ptr<const SearchMesh> search_mesh;
  std::mutex mutex;
  std::vector<std::unique_ptr<WindowSearch>> idle;

  /// A search that is taken from the pool for the lifetime of the lease.
  class Lease {
   public:
    explicit Lease(Implementation& owner) : owner_(owner) {
      {
        const std::lock_guard lock(owner_.mutex);
        if (!owner_.idle.empty()) {
          search_ = std::move(owner_.idle.back());
          owner_.idle.pop_back();
        }
      }
      if (!search_) search_ = std::make_unique<WindowSearch>(*owner_.search_mesh);
    }
    ~Lease() {
      search_->give_back_memory();
      const std::lock_guard lock(owner_.mutex);
      owner_.idle.push_back(std::move(search_));
    }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    WindowSearch& operator*() { return *search_; }
    WindowSearch* operator->() { return search_.get(); }

   private:
    Implementation& owner_;
    std::unique_ptr<WindowSearch> search_;
  };
};

}  // namespace supple::surface
