#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// What came back, whatever its status.
struct Answer {
  int status = 0;
  std::string content_type;
  std::string location;    ///< of a created mesh or an accepted job; empty otherwise
  double retry_after = 0;  ///< seconds the server asks to wait before the next look; 0 where it says nothing
  std::string body;
  std::string largest_distance;  ///< of the request's points in space from the surface; empty where there are none

  /// The body as JSON. Throws Failure(server_error) where it is none.
  nlohmann::json json() const;
};

/// One server, spoken to over HTTP/1.1. Sends one request at a time.
///
/// Every call throws Failure(unreachable) where no answer arrives, Failure(rejected) for a 4xx answer and
/// Failure(server_error) for a 5xx one, with the problem's sentence, code and the fields it names.
class HttpClient {
 public:
  /// `url` is scheme, host and port, e.g. http://127.0.0.1:8080. Throws Failure(usage) where it is not. The key, if
  /// there is one, goes along with each request as a header.
  explicit HttpClient(const std::string& url, const std::string& key = "");
  ~HttpClient();
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  const std::string& url() const { return url_; }

  Answer get(const std::string& path, const std::string& accept = "application/json");
  /// `prefer` is the value of the Prefer header; empty for none.
  Answer post(const std::string& path, const std::string& body, const std::string& content_type,
              const std::string& accept = "application/json", const std::string& prefer = "");
  Answer erase(const std::string& path);

  /// Breaks the request in progress, from any thread: the call that waits for it throws.
  void abort();

 private:
  struct Connection;
  std::string url_;
  std::unique_ptr<Connection> connection_;
};

}  // namespace supple::cli
