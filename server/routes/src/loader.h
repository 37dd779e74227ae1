#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "supple/base/execution.h"
#include "supple/http/message.h"
#include "supple/routes/services.h"
#include "supple/store/mesh_cache.h"
#include "supple/surface/nearest_point.h"
#include "supple/tiling/family.h"

namespace supple::routes {

/// The priority of what has to be done before a request can become a computation. Whoever asks for something in the
/// background does not wait for other background jobs until it is accepted.
Priority priority_of_preparation(std::string_view body);

/// Gives an endpoint what it prepares a computation from: the server's limits and models, and the meshes and families
/// that the request may see. One thread at a time.
class Loader {
 public:
  using Clock = std::chrono::steady_clock;

  /// For a thread that answers `request`, which it began at `begin`, and computes nothing yet. What takes long is done
  /// within a compute slot and the deadline, and for as long as the client is there.
  Loader(const Services& services, const http::Request& request, Clock::time_point begin)
      : services_(services), request_(request), begin_(begin) {}
  /// For a thread that computes: `execution` stops what it loads.
  Loader(const Services& services, const http::Request& request, const Execution& execution)
      : services_(services), request_(request), execution_(&execution) {}

  /// The id of the request's key; empty where none is needed.
  const std::string& owner() const { return request_.key; }
  const json::Limits& limits() const { return services_.limits.json; }
  /// The family of this name: one that comes with the server, one that the request's key has added, or one that a
  /// loaded model defines. Throws "tiling.family_not_found", which lists them.
  std::shared_ptr<const tiling::Family> family(const std::string& name) const;
  /// The definition, as tiling::to_text writes it, of the family of this name that the request's key has added; empty
  /// if there is none.
  std::string definition_of_added(const std::string& name) const;
  /// The ids of the added families that were asked for, separated by commas.
  const std::string& added_families() const { return added_families_; }

  /// The models that the request's key sees.
  store::VisibleModels models() const { return {*services_.models, request_.key}; }
  metrics::Metrics& metrics() const { return *services_.metrics; }
  /// The memory that requests may take; null: there is no limit.
  const budget::MemoryBudget* memory() const { return services_.memory; }
  /// Stops the parsing of a body.
  CancellationToken cancellation() const { return execution_ ? execution_->cancellation : CancellationToken(); }

  /// The mesh of a computation with this deadline in seconds. Throws "mesh.not_found" with a pointer to the field, also
  /// where the request may not see the mesh, and what ends a computation.
  std::shared_ptr<const store::LoadedMesh> mesh(const std::string& id, double deadline) const;

  /// The search for nearest points of a mesh, which is made at its first use. Throws what ends a computation.
  const surface::NearestPointSearch& nearest_search(const std::string& id, const store::LoadedMesh& mesh,
                                                    double deadline) const;

 private:
  /// Runs what takes long and concerns a mesh.
  void run(const std::string& mesh, double deadline, const std::function<void(const Execution&)>& work) const;

  const Services& services_;
  const http::Request& request_;
  Clock::time_point begin_{};
  const Execution* execution_ = nullptr;  ///< null for a thread that computes nothing yet
  mutable std::string added_families_;
};

}  // namespace supple::routes
