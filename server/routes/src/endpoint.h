#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "loader.h"
#include "supple/base/execution.h"
#include "supple/http/router.h"
#include "supple/routes/services.h"
#include "supple/store/records.h"

namespace supple::routes {

/// What an endpoint makes a computation of.
struct EndpointRequest {
  const std::string& body;                                    ///< JSON text
  const std::map<std::string, std::string>& path_parameters;  ///< as in http::Request
  std::string_view format;                                    ///< media type of the answer, one of the endpoint's
  bool becomes_job = false;                                   ///< false: it is answered immediately
};

/// A computation that is ready to run.
struct PreparedComputation {
  std::string mesh{};     ///< id of the mesh that it works on; empty: none
  double deadline = 0;    ///< seconds
  std::string session{};  ///< an unfinished computation of the same session is superseded; empty: none is
  std::function<store::Result(const Execution&)> run{};
};

/// A path to which clients POST a request as JSON, and which computes. Answers and the repetition of a job after a
/// restart both get their computation from `prepare`.
struct Endpoint {
  using Prepare = std::function<PreparedComputation(const EndpointRequest&, const Loader&)>;

  std::string path{};   ///< pattern, as in http::Route; empty: "/v1/" and the kind
  std::string kind{};   ///< kind of its jobs: "karcher-means"
  std::string sends{};  ///< what its answer is, for the problem that no format is acceptable: "A field is sent as"
  /// Media types of the answer. The first one is that of a request without the header Accept; if there is no other one,
  /// the header does not count.
  std::vector<std::string_view> formats{"application/json"};
  bool is_long = false;  ///< it is always answered with a job
  /// Parses and validates. Throws what the client is told, and the error of a stop request.
  Prepare prepare{};
};

void add_endpoint(http::Router& router, Services& services, Endpoint endpoint);

/// The answer to a request for which nothing has to be computed; none if something has.
using ReadyAnswer = std::function<std::optional<http::Response>(const http::Request&)>;

/// The same for a path from which clients GET what may be there already. What is not there is computed like the answer
/// to a POST without a body.
void add_get_endpoint(http::Router& router, Services& services, Endpoint endpoint, ReadyAnswer ready_answer);

/// The media types of answers that are JSON or one of these files; entries of `files` have a `media_type`.
template <class Files>
std::vector<std::string_view> json_or(const Files& files) {
  std::vector<std::string_view> types{"application/json"};
  for (const auto& file : files) types.push_back(file.media_type);
  return types;
}

/// The file of a media type; null for JSON.
template <class File, std::size_t count>
const File* file_of(const File (&files)[count], std::string_view media_type) {
  const auto* const found =
      std::find_if(files, files + count, [&](const File& file) { return file.media_type == media_type; });
  return found == files + count ? nullptr : found;
}

}  // namespace supple::routes
