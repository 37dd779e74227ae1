#include "admission.h"

#include <array>
#include <atomic>
#include <charconv>
#include <cstdint>
#include <random>

namespace supple::http {
namespace {

/// A new id of a request, 16 hexadecimal digits. Ids count on from a random number, so that they are unique in this
/// process and very probably among all processes. They are not secret.
std::string next_request_id() {
  static std::atomic<std::uint64_t> next{std::uint64_t{std::random_device{}()} << 32U};
  constexpr std::size_t length = 16;
  std::array<char, length> digits{};
  char* const end = std::to_chars(digits.data(), digits.data() + length, next++, 16).ptr;
  std::string text(digits.data(), end);
  return text.insert(0, length - text.size(), '0');
}

void check_body(const Request& request) {
  if (media_type(request.header("Content-Type")) == "multipart/form-data") {
    throw Error("http.unsupported_media_type",
                "Forms (multipart/form-data) are not read; send the content itself as the body.");
  }
  const auto encoding = request.header("Content-Encoding");
  if (!encoding.empty() && encoding != "identity") {
    throw Error("http.unsupported_media_type",
                "Compressed bodies are not read; send the body without Content-Encoding.");
  }
}

}  // namespace

void Admission::admit(Connection& connection) const {
  const auto& head = *connection.head();
  auto& request = connection.request;
  request.id = next_request_id();
  request.method = head.method;
  request.path = head.path;
  request.host = head.host;
  request.query = read_query(head.query);
  request.headers = head.headers;
  request.peer = Peer(connection.socket());
  request.client = connection.client();
  // The guard is asked first, so that a client without a key does not learn which paths exist.
  std::exception_ptr no_route;
  try {
    auto match = router_.find(head.method, head.path);
    connection.route = match.route;
    request.path_parameters = std::move(match.path_parameters);
  } catch (const Error&) {
    no_route = std::current_exception();
  }
  if (guard_) guard_(request, connection.route);
  if (no_route) std::rethrow_exception(no_route);
  if (head.has_body()) check_body(request);
}

}  // namespace supple::http
