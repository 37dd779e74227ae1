#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "supple/base/priority.h"

namespace supple::store {

/// A stored mesh. `description` is the JSON that clients get.
struct MeshRecord {
  std::string id;            ///< SHA-256 of the canonical content, hexadecimal
  std::int64_t created = 0;  ///< milliseconds since 1970
  std::string description;
};

/// A family of tilings that a client has added.
struct FamilyRecord {
  std::string id;            ///< 128 random bits, hexadecimal; a family that is added again gets another one
  std::string owner;         ///< id of the key that added it; empty where none was needed
  std::string name;          ///< unique among the families of its owner
  std::int64_t created = 0;  ///< milliseconds since 1970
  std::string definition;    ///< the family as JSON
  std::string description;   ///< the JSON that clients get
};

enum class JobState { accepted, running, successful, failed, dismissed };

std::string_view state_name(JobState state);
std::optional<JobState> state_of(std::string_view name);

/// 128 random bits of the system, hexadecimal.
std::string random_id();

/// What is stored of a job. Times are in milliseconds since 1970, and 0 for what has not happened yet.
struct JobRecord {
  std::string id;    ///< 128 random bits, hexadecimal
  std::string kind;  ///< for example "karcher-means"
  std::string mesh;  ///< id of the mesh that it works on; empty where there is none
  JobState state = JobState::accepted;
  std::int64_t created = 0;
  std::int64_t started = 0;
  std::int64_t finished = 0;
  std::int64_t expires = 0;
  double deadline = 0;          ///< seconds
  std::string error;            ///< problem JSON of a failed job
  int error_status = 0;         ///< its HTTP status
  std::string client;           ///< its client, among whom the queue takes turns; empty where they are not told apart
  std::string session;          ///< session of its computation; empty where there is none
  std::string owner;            ///< id of the key that it was made for; empty where none was needed
  int attempts = 0;             ///< number of starts, except those that a shutdown of the server interrupted
  std::string idempotency_key;  ///< hash of the access key and the idempotency key; empty where none was sent
  std::string request_hash;     ///< hash of the request that came with that key
  Priority priority = Priority::normal;
  std::string families;            ///< ids of the added families that it needs, separated by commas
  std::int64_t fencing_token = 0;  ///< number of its lease, in a shared store
};

/// A job that is leased to a server of a shared store. If another server has taken the job since, its fencing token has
/// grown.
struct LeasedJob {
  std::string id;
  std::int64_t fencing_token = 0;
};

/// How many jobs a server could start now: of those in the background, and of the others.
struct IdleWorkers {
  std::size_t foreground = 0;
  std::size_t background = 0;
};

/// Progress of a job.
struct JobProgress {
  std::string id;
  double fraction = 0;  ///< in [0, 1]
  std::string stage;
  std::string partial;        ///< JSON of an intermediate result; empty where there is none
  std::int64_t revision = 0;  ///< grows with every change
};

/// The request of a job without its body. A later process can make the job again from it.
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
