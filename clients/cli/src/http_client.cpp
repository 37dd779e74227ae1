#include "http_client.h"

#include <fmt/format.h>
#include <httplib.h>

#include <charconv>
#include <chrono>
#include <functional>

#include "failure.h"
#include "problem.h"

namespace supple::cli {
namespace {

constexpr auto connect_timeout = std::chrono::seconds(5);
/// Long enough for the upload of a large mesh. Computations do not need it, since they are followed as jobs.
constexpr auto answer_timeout = std::chrono::minutes(10);

double seconds_in(const std::string& text) {
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value > 0 ? value : 0;
}

}  // namespace

nlohmann::json Answer::json() const {
  try {
    return nlohmann::json::parse(body);
  } catch (const nlohmann::json::exception&) {
    throw Failure(ExitCode::server_error, fmt::format("the server's answer (status {}, {}) is not JSON", status,
                                                      content_type.empty() ? "no content type" : content_type));
  }
}

struct HttpClient::Connection {
  explicit Connection(const std::string& url) : client(url) {
    client.set_connection_timeout(connect_timeout);
    client.set_read_timeout(answer_timeout);
    client.set_write_timeout(answer_timeout);
    client.set_keep_alive(true);
    client.set_tcp_nodelay(true);
  }

  Answer call(const std::string& url, const std::function<httplib::Result(httplib::Client&)>& request) {
    const httplib::Result result = request(client);
    if (!result) {
      throw Failure(ExitCode::unreachable, fmt::format("no answer from {} ({}): is supple-server running there?", url,
                                                       httplib::to_string(result.error())));
    }
    Answer answer{result->status,
                  result->get_header_value("Content-Type"),
                  result->get_header_value("Location"),
                  seconds_in(result->get_header_value("Retry-After")),
                  result->body,
                  result->get_header_value("Supple-Largest-Distance")};
    if (answer.status >= 400) throw_problem(answer.status, answer.body);
    return answer;
  }

  httplib::Client client;
};

HttpClient::HttpClient(const std::string& url, const std::string& key) : url_(url) {
  while (url_.ends_with('/')) url_.pop_back();
  if (!url_.starts_with("http://") && !url_.starts_with("https://")) {
    throw Failure(ExitCode::usage, fmt::format("'{}' is not a server address such as http://127.0.0.1:8080", url));
  }
  connection_ = std::make_unique<Connection>(url_);
  if (!connection_->client.is_valid()) {
    throw Failure(ExitCode::usage, fmt::format("'{}' is not a server address such as http://127.0.0.1:8080", url));
  }
  if (!key.empty()) connection_->client.set_bearer_token_auth(key);
}

HttpClient::~HttpClient() = default;

Answer HttpClient::get(const std::string& path, const std::string& accept) {
  return connection_->call(url_, [&](httplib::Client& client) { return client.Get(path, {{"Accept", accept}}); });
}

Answer HttpClient::post(const std::string& path, const std::string& body, const std::string& content_type,
                        const std::string& accept, const std::string& prefer) {
  httplib::Headers headers{{"Accept", accept}};
  if (!prefer.empty()) headers.emplace("Prefer", prefer);
  return connection_->call(url_,
                           [&](httplib::Client& client) { return client.Post(path, headers, body, content_type); });
}

Answer HttpClient::erase(const std::string& path) {
  return connection_->call(url_, [&](httplib::Client& client) { return client.Delete(path); });
}

void HttpClient::abort() { connection_->client.stop(); }

}  // namespace supple::cli
