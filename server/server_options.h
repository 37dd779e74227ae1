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

/// All settings of the server.
struct ServerOptions {
  http::ServerOptions http;
  jobs::QueueOptions jobs;
  routes::RouteLimits limits;
  std::string data = "data";
  std::string database;  ///< connection string (libpq) of a shared database; empty: a database of its own
  double lease = 10;     ///< seconds without a sign of life after which other servers take a server's jobs
  std::string models;    ///< folder of models; empty: none
  std::int64_t max_model = 256LL << 20;   ///< largest model file in bytes
  std::string web;                        ///< folder of the built web editor; empty: none
  int threads = 0;                        ///< compute threads; 0: one for each core
  std::int64_t max_store = 0;             ///< bytes of the data folder; 0: nine tenths of its disk
  std::int64_t max_mesh_bytes = 0;        ///< bytes of stored meshes; 0: no limit but max_store
  double mesh_retention = 0;              ///< seconds after which an unused mesh is removed; 0: never
  std::int64_t mesh_memory = 0;           ///< bytes of loaded meshes; read_options computes the default
  double drain = 0;                       ///< seconds after SIGTERM in which it answers but is not ready
  double grace = 5;                       ///< seconds that running computations get to finish at the end
  std::int64_t memory = 0;                ///< bytes of all requests together; read_options computes the default
  std::int64_t process_memory = 0;        ///< bytes above which computations are stopped; set by read_options
  std::int64_t request_memory = 0;        ///< bytes of one request; read_options computes the default
  std::int64_t max_answer = 256LL << 20;  ///< largest answer in JSON, in bytes
  std::vector<std::string> allowed_hosts;
  std::vector<std::string> allowed_origins;
  std::string keys;                         ///< file of keys; empty: the file "keys" in the data folder
  bool open = false;                        ///< whether no request needs a key
  bool access_log = false;                  ///< whether each answered request is logged
  HelperOptions helper{{}, 0, 0};           ///< helper processes; without a program everything runs in this one
  routes::LabSettings lab{{}, 8ULL << 30};  ///< the program that trains networks
  std::string log_level = "info";

  /// When requests need a key.
  access::Rule rule_of_keys() const;
  access::KeyFile key_file() const { return access::KeyFile(keys.empty() ? data + "/keys" : keys); }
};

/// Reads the configuration file, the environment and the command line; each one takes precedence over the previous one.
/// If the command line contains a command, runs it, which may throw std::runtime_error. Returns the exit status if the
/// process is to end (help, version, an error, --check-config, a command). Unused variables are reported on standard
/// error.
std::optional<int> read_options(int argc, char** argv, ServerOptions& options);

}  // namespace supple
