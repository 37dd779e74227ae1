#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// An answer of the server, with any status.
struct Answer {
  int status = 0;
  std::string content_type;
  std::string location;    ///< path of a created mesh or an accepted job; empty otherwise
  double retry_after = 0;  ///< seconds after which the server wants to be asked again; 0 if it says nothing
  std::string body;
  std::string largest_distance;  ///< largest distance of the request's points in space from the surface; else empty

  /// The body as JSON. Throws Failure(server_error) if it is none.
  nlohmann::json json() const;
};

/// The connection to one server over HTTP/1.1. It sends one request at a time.
///
/// Every call throws Failure(unreachable) if no answer arrives, Failure(rejected) for a 4xx answer and
/// Failure(server_error) for a 5xx one, with the problem's sentence, code and the fields it names.
class HttpClient {
 public:
  /// `url` is scheme, host and port, such as http://127.0.0.1:8080; Failure(usage) is thrown if it is not. Each request
  /// has the key, if there is one, in a header.
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

  /// Aborts the request in progress, so that the call that waits for it throws. Any thread may call this.
  void abort();

 private:
  struct Connection;
  std::string url_;
  std::unique_ptr<Connection> connection_;
};

}  // namespace supple::cli
