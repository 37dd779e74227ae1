#pragma once

#include <cstdint>
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
  double deadline = 0;   ///< seconds
  std::string error;     ///< problem JSON of a failed job
  int error_status = 0;  ///< its HTTP status
};

/// The answer of a computation, as bytes.
struct Result {
  std::string content_type;
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;
};

}  // namespace supple::store
