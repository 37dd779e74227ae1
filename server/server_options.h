#pragma once

#include <optional>
#include <string>
#include <vector>

#include "supple/access/gate.h"
#include "supple/access/key_file.h"
#include "supple/base/helper_processes.h"
#include "supple/http/server.h"
#include "supple/jobs/job_queue.h"
#include "supple/routes/services.h"

namespace supple {

/// Everything that the command line sets.
struct ServerOptions {
  http::ServerOptions http;
  jobs::QueueOptions jobs;
  routes::RouteLimits limits;
  std::string data = "data";
  std::string database;  ///< that servers share: a connection string of libpq; one of its own where empty
  double lease = 10;     ///< seconds that a server of a shared database keeps its jobs without a word
  std::string models;    ///< folder; none where empty
  std::int64_t max_model = 256LL << 20;   ///< bytes of a model file
  std::string web;                        ///< folder of the built web editor; none where empty
  int threads = 0;                        ///< compute threads; 0: one for each core
  std::int64_t max_store = 0;             ///< bytes of the data folder; 0: a share of the disk's
  std::int64_t max_mesh_bytes = 0;        ///< of stored meshes; 0: no limit but that of the data folder
  double mesh_retention = 0;              ///< seconds that a mesh is kept which nobody uses; 0: for good
  std::int64_t mesh_memory = 0;           ///< bytes; like the following ones a share of the machine's at first
  double drain = 0;                       ///< seconds that it answers at the end although it is not ready any more
  double grace = 5;                       ///< seconds that running computations get at the end
  std::int64_t memory = 0;                ///< bytes that requests and computations may take together
  std::int64_t process_memory = 0;        ///< bytes of the whole process, at which computations are stopped
  std::int64_t request_memory = 0;        ///< bytes that one request may take
  std::int64_t max_answer = 256LL << 20;  ///< bytes of an answer in JSON
  std::vector<std::string> allowed_hosts;
  std::vector<std::string> allowed_origins;
  std::string keys;                ///< file of keys; the file "keys" in the data folder where empty
  bool open = false;               ///< nobody needs a key
  bool access_log = false;         ///< a line for each answered request
  HelperOptions helper{{}, 0, 0};  ///< everything in this process where its program is empty
  std::string log_level = "info";

  /// When requests need a key.
  access::Rule rule_of_keys() const;
  access::KeyFile key_file() const { return access::KeyFile(keys.empty() ? data + "/keys" : keys); }
};

/// Reads the configuration file, the environment and the command line, each of which counts more than the one before,
/// and runs the command line's command where there is one. Returns the exit status where the process is to end at once
/// (help, version, a mistake, --check-config, a command that has run). Commands throw std::runtime_error. What of the
/// environment is not used is told on standard error.
std::optional<int> read_options(int argc, char** argv, ServerOptions& options);

}  // namespace supple
