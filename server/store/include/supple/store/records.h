#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supple::store {

/// A stored mesh. `description` is the JSON that clients get.
struct MeshRecord {
  std::string id;            ///< SHA-256 of the canonical content, hexadecimal
  std::int64_t created = 0;  ///< milliseconds since 1970
  std::string description;
};

enum class JobState { accepted, running, successful, failed, dismissed };

std::string_view state_name(JobState state);
std::optional<JobState> state_of(std::string_view name);

/// A job without what only lives while it runs. Times in milliseconds since 1970, 0 where they have not come yet.
struct JobRecord {
  std::string id;    ///< 128 random bits, hexadecimal
  std::string kind;  ///< "karcher-means"
  std::string mesh;  ///< empty where it works on none
  JobState state = JobState::accepted;
  std::int64_t created = 0;
  std::int64_t started = 0;
  std::int64_t finished = 0;
  std::int64_t expires = 0;
  double deadline = 0;          ///< seconds
  std::string error;            ///< problem JSON of a failed job
  int error_status = 0;         ///< its HTTP status
  std::string client;           ///< whose turn in the queue it takes; empty where clients are not told apart
  std::string session;          ///< of its computation; empty: of none
  std::string owner;            ///< the id of the key that it was made for; empty: of none
  int attempts = 0;             ///< how often it was begun, without those times that ended in good order
  std::string idempotency_key;  ///< of who asked for it and how they named it, as a hash; empty: they named it not
  std::string request_hash;     ///< of what was asked with that key
  std::int64_t hold = 0;        ///< number of the hold that a server has on it, in a shared store
};

/// A job that a server of a shared store holds: with another number it has been taken by another server since.
struct HeldJob {
  std::string id;
  std::int64_t hold = 0;
};

/// How far a job is.
struct JobProgress {
  std::string id;
  double fraction = 0;  ///< in [0, 1]
  std::string stage;
  std::string partial;        ///< JSON of an intermediate result; empty where there is none
  std::int64_t revision = 0;  ///< grows with every change
};

/// What a job is made again from in a later process. Its body is kept beside it.
struct JobRequest {
  std::string method;
  std::string path;
  std::map<std::string, std::string> query;
  std::string content_type;
  std::string accept;
};

struct StoredRequest {
  JobRequest request;
  std::string body;
};

/// The answer of a computation, as bytes.
struct Result {
  std::string content_type;
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;
};

}  // namespace supple::store
