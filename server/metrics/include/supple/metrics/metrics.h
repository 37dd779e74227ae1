#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace supple::metrics {

/// What is counted elsewhere and read when the counters are asked for.
struct Snapshot {
  std::map<std::string, std::int64_t> jobs;  ///< by state: those that this process holds or has finished
  std::int64_t connections = 0;
  std::int64_t event_streams = 0;
  std::int64_t answering = 0;     ///< requests that are answered at the moment, probes aside
  std::int64_t evicted = 0;       ///< connections closed so far to make room for others
  double lobby_silence = 0;       ///< seconds since what arrives on connections was looked at
  double listener_silence = 0;    ///< seconds since connections were accepted, or looked for
  std::int64_t used_bytes = 0;    ///< of the memory budget, by requests and computations
  std::int64_t budget_bytes = 0;  ///< the memory budget
  std::int64_t computations = 0;  ///< immediate ones that run or wait
  std::int64_t abandoned = 0;     ///< computations that do not stop
  std::int64_t meshes_loaded = 0;
  std::int64_t mesh_bytes = 0;  ///< estimate of the loaded meshes
  std::int64_t models_loaded = 0;
  std::int64_t models_damaged = 0;                  ///< files that cannot be read
  std::int64_t disk_free_bytes = 0;                 ///< of the data folder
  std::map<std::string, std::int64_t> store_bytes;  ///< that the data folder holds, by part
  std::int64_t store_limit = 0;                     ///< of them together, in bytes
};

/// The server's counters in the Prometheus text format. Any thread may call.
class Metrics {
 public:
  explicit Metrics(const std::string& version);
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  /// `route` is a pattern, never a path, so that the number of series stays bounded; "" becomes "none".
  void count_request(const std::string& route, const std::string& method, int status, double seconds);
  void count_finished_job(const std::string& kind, const std::string& state, double seconds);
  /// Where an immediate answer's time went: `stage` is "read" (its JSON, its mesh), "wait" (for a slot) or "compute".
  void observe_stage(const std::string& stage, double seconds);
  /// The most bytes that a computation held.
  void observe_memory(std::int64_t bytes);
  /// States whose stress or energy a model has given. Ids are those of loaded models, never of requests.
  void count_evaluations(const std::string& model, std::int64_t states);
  std::string text(const Snapshot& snapshot);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::metrics
