#include "request_head.h"

#include <strings.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "supple/base/error.h"
#include "text.h"

namespace supple::http {
namespace {

constexpr std::size_t max_path_bytes = 2048;
constexpr std::size_t max_target_bytes = 8192;
constexpr std::size_t max_headers = 100;
constexpr std::size_t max_length_digits = 18;  // decimal digits, so that lengths are below 2^63

[[noreturn]] void refuse(const std::string& what) { throw Error("http.bad_request", what); }

bool equals_ignoring_case(std::string_view a, std::string_view b) {
  return a.size() == b.size() && ::strncasecmp(a.data(), b.data(), a.size()) == 0;
}

/// Removes the next line from the text and returns it without its CR LF.
std::string_view take_line(std::string_view& text) {
  const auto end = text.find("\r\n");
  if (end == std::string_view::npos) refuse("A line of the request's head does not end in CR LF.");
  const auto line = text.substr(0, end);
  text.remove_prefix(end + 2);
  if (has_control_character(line)) refuse("The request's head contains a control character.");
  return line;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// Decodes percent escapes. A "%" without two hexadecimal digits stays as it is, which is what browsers do too.
std::string percent_decoded(std::string_view text, bool plus_is_space = false) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0) {
      result += static_cast<char>(16 * hex_digit(text[i + 1]) + hex_digit(text[i + 2]));
      i += 2;
    } else {
      result += plus_is_space && text[i] == '+' ? ' ' : text[i];
    }
  }
  return result;
}

void read_target(std::string_view target, RequestHead& head) {
  if (target.size() > max_target_bytes) {
    throw Error("http.uri_too_long", "The request target has " + std::to_string(target.size()) +
                                         " bytes, the limit is " + std::to_string(max_target_bytes) + ".");
  }
  constexpr std::string_view scheme = "http://";
  if (target.size() > scheme.size() && equals_ignoring_case(target.substr(0, scheme.size()), scheme)) {
    // The absolute form, which clients of proxies send. Its authority replaces the header Host (RFC 9112, 3.2.2).
    target.remove_prefix(scheme.size());
    const auto slash = std::min(target.find('/'), target.size());
    head.host = target.substr(0, slash);
    target.remove_prefix(slash);
    if (target.empty()) target = "/";
  }
  if (target.empty() || target.front() != '/') refuse("The request target is not a path that begins with a slash.");
  head.target = target;
  const auto question = target.find('?');
  const auto path = target.substr(0, question);
  if (path.size() > max_path_bytes) {
    throw Error("http.uri_too_long", "The path has " + std::to_string(path.size()) + " bytes, the limit is " +
                                         std::to_string(max_path_bytes) + ".");
  }
  head.path = percent_decoded(path);
  if (head.path.find('\0') != std::string::npos) refuse("The path contains the escape of a NUL character.");
  if (question != std::string_view::npos) head.query = target.substr(question + 1);
}

void read_request_line(std::string_view line, RequestHead& head) {
  constexpr std::array<std::string_view, 8> methods{"GET",   "HEAD",   "POST",    "PUT",
                                                    "PATCH", "DELETE", "OPTIONS", "TRACE"};
  const auto first = line.find(' ');
  const auto last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) {
    refuse("The request line is not a method, a target and a version between single spaces.");
  }
  head.method = line.substr(0, first);
  if (std::find(methods.begin(), methods.end(), head.method) == methods.end()) {
    refuse("The request's method is not one of GET, HEAD, POST, PUT, PATCH, DELETE and OPTIONS.");
  }
  const auto version = line.substr(last + 1);
  if (version != "HTTP/1.1" && version != "HTTP/1.0") refuse("The request's version is neither HTTP/1.1 nor HTTP/1.0.");
  head.minor_version = version.back() - '0';
  const auto target = line.substr(first + 1, last - first - 1);
  if (target.find(' ') != std::string_view::npos) refuse("The request target contains a space.");
  read_target(target, head);
}

std::uint64_t read_length(std::string_view text) {
  const bool all_digits =
      !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!all_digits || text.size() > max_length_digits) refuse("The header Content-Length is not a number of bytes.");
  std::uint64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

void read_framing(RequestHead& head) {
  std::size_t hosts = 0;
  std::size_t lengths = 0;
  std::size_t codings = 0;
  for (const auto& [name, value] : head.headers) {
    if (equals_ignoring_case(name, "Host")) {
      ++hosts;
      if (head.host.empty()) head.host = value;
    } else if (equals_ignoring_case(name, "Content-Length")) {
      ++lengths;
      head.content_length = read_length(value);
    } else if (equals_ignoring_case(name, "Transfer-Encoding")) {
      ++codings;
      head.chunked = equals_ignoring_case(value, "chunked");
      if (!head.chunked) refuse("The header Transfer-Encoding names another coding than chunked.");
    } else if (equals_ignoring_case(name, "Expect")) {
      head.expects_continue = equals_ignoring_case(value, "100-continue");
    }
  }
  if (hosts > 1) refuse("The request has more than one header Host.");
  if (hosts == 0 && head.minor_version == 1) refuse("The request has no header Host.");
  if (lengths > 1) refuse("The request has more than one header Content-Length.");
  if (codings > 1) refuse("The request has more than one header Transfer-Encoding.");
  if (codings > 0 && lengths > 0) refuse("The request has both Transfer-Encoding and Content-Length.");
  if (codings > 0 && head.minor_version == 0) refuse("A request of HTTP/1.0 has the header Transfer-Encoding.");
}

}  // namespace

std::string_view RequestHead::header(std::string_view name) const {
  for (const auto& [key, value] : headers) {
    if (equals_ignoring_case(key, name)) return value;
  }
  return {};
}

bool RequestHead::asks_to_close() const {
  bool closes = minor_version == 0;
  for (const auto& [key, value] : headers) {
    if (!equals_ignoring_case(key, "Connection")) continue;
    for (std::string_view left = value; !left.empty();) {
      const auto end = std::min(left.find(','), left.size());
      const auto option = trimmed(left.substr(0, end));
      if (equals_ignoring_case(option, "close")) return true;
      if (equals_ignoring_case(option, "keep-alive")) closes = false;
      left.remove_prefix(std::min(end + 1, left.size()));
    }
  }
  return closes;
}

std::size_t end_of_head(std::string_view text, std::size_t searched) {
  constexpr std::string_view end_mark = "\r\n\r\n";
  const auto end = text.find(end_mark, searched - std::min(searched, end_mark.size() - 1));
  return end == std::string_view::npos ? end : end + end_mark.size();
}

RequestHead read_head(std::string_view text) {
  RequestHead head;
  read_request_line(take_line(text), head);
  while (true) {
    const auto line = take_line(text);
    if (line.empty()) break;
    if (line.front() == ' ' || line.front() == '\t') refuse("A header is folded over several lines.");
    const auto colon = line.find(':');
    if (colon == std::string_view::npos || !is_token(line.substr(0, colon))) {
      refuse("A header is not a name directly followed by a colon.");
    }
    if (head.headers.size() == max_headers) {
      refuse("The request has more than " + std::to_string(max_headers) + " headers.");
    }
    head.headers.emplace_back(line.substr(0, colon), trimmed(line.substr(colon + 1)));
  }
  read_framing(head);
  return head;
}

std::map<std::string, std::string> read_query(std::string_view query) {
  std::map<std::string, std::string> parameters;
  while (!query.empty()) {
    const auto end = std::min(query.find('&'), query.size());
    const auto pair = query.substr(0, end);
    const auto equals = std::min(pair.find('='), pair.size());
    if (!pair.empty()) {
      parameters.emplace(percent_decoded(pair.substr(0, equals), true),
                         equals < pair.size() ? percent_decoded(pair.substr(equals + 1), true) : std::string());
    }
    query.remove_prefix(std::min(end + 1, query.size()));
  }
  return parameters;
}

}  // namespace supple::http
