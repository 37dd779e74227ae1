#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "supple/access/gate.h"
#include "supple/http/server.h"
#include "supple/jobs/job_queue.h"
#include "supple/json/limits.h"
#include "supple/metrics/metrics.h"
#include "supple/store/mesh_cache.h"
#include "supple/store/model_store.h"
#include "supple/surface/mesh_io.h"

namespace supple::routes {

struct RouteLimits {
  std::uint64_t max_body = 512ULL << 20;  ///< bytes of a mesh file; setting --max-body
  std::uint64_t max_json = 64ULL << 20;   ///< bytes of a JSON body; setting --max-json
  int event_streams = 32;                 ///< followed at the same time; setting --event-streams
  double max_wait = 300;                  ///< seconds of Prefer: wait; fixed
  std::int64_t min_free = 16LL << 20;     ///< bytes of the data folder's disk while it is ready; setting --min-free
  double max_training = 7 * 86400;        ///< seconds of a training's deadline; setting --max-training
  json::Limits json;
  surface::MeshLimits mesh;
};

/// The program that trains networks.
struct LabSettings {
  std::string program;       ///< file of supple-lab; empty: networks are not trained here
  std::uint64_t memory = 0;  ///< bytes of address space of a run; 0: no limit
};

/// What the routes call. `store`, `meshes`, `models` and `jobs` are null until the server is ready; the routes that
/// need them answer "server.not_ready" until then.
struct Services {
  RouteLimits limits;
  std::string version;
  std::string data;  ///< data folder
  std::string web;   ///< folder of the built web editor; empty: none
  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  metrics::Metrics* metrics = nullptr;
  store::Store* store = nullptr;
  store::MeshCache* meshes = nullptr;
  store::ModelStore* models = nullptr;
  jobs::JobQueue* jobs = nullptr;
  std::atomic<bool> ready{false};  ///< set after the pointers, and read before them
  std::atomic<bool> stopping{false};
  std::atomic<bool> draining{false};  ///< answers, but tells load balancers to ask others
  std::atomic<int> event_streams{0};
  std::function<http::Load()> load;
  budget::MemoryBudget* memory = nullptr;
  access::Gate* gate = nullptr;  ///< knows the keys; null: nobody needs one
  LabSettings lab;
  std::string atlases;  ///< folder of the atlases that are shipped; empty or missing: none
};

}  // namespace supple::routes
