#include <algorithm>
#include <charconv>
#include <sstream>
#include <stdexcept>

#include "supple/access/duration.h"
#include "supple/access/key_file.h"

namespace supple::access {
namespace {

constexpr std::string_view heading =
    "# Keys of supple-server, changed by \"supple-server keys\". Secrets are not in here, only their salted SHA-256.\n";

std::string hash_text(const SecretHash& hash) { return hash.salt + " " + hash.digest; }

SecretHash parse_hash(const std::string& text) {
  constexpr std::size_t digest_length = 64;
  const auto space = text.find(' ');
  SecretHash hash{text.substr(0, space), space == std::string::npos ? "" : text.substr(space + 1)};
  const auto other = (hash.salt + hash.digest).find_first_not_of("0123456789abcdef");
  if (hash.salt.empty() || hash.digest.size() != digest_length || other != std::string::npos)
    throw std::runtime_error("'" + text + "' is not a salt and a SHA-256");
  return hash;
}

template <class Number>
Number parse_count(const std::string& text) {
  Number value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 1)
    throw std::runtime_error("'" + text + "' is no positive integer");
  return value;
}

void read_field(Key& key, const std::string& field, const std::string& value) {
  if (field == "name") {
    key.name = value;
  } else if (field == "scopes") {
    key.scopes = parse_scopes(value);
  } else if (field == "secret") {
    key.secret = parse_hash(value);
  } else if (field == "previous") {
    key.previous = parse_hash(value);
  } else if (field == "previous_until") {
    key.previous_until = parse_time(value);
  } else if (field == "created") {
    key.created = parse_time(value);
  } else if (field == "expires") {
    key.expires = parse_time(value);
  } else if (field == "requests_per_minute") {
    key.requests_per_minute = parse_count<int>(value);
  } else if (field == "max_waiting_jobs") {
    key.max_waiting_jobs = parse_count<int>(value);
  } else if (field == "max_stored") {
    key.max_stored = parse_count<std::int64_t>(value);
  } else {
    throw std::runtime_error("there is no field '" + field + "'");
  }
}

void read_line(std::vector<Key>& keys, const std::string& line) {
  const bool is_field = line.starts_with("  ");
  const auto begin = is_field ? 2 : 0;
  const auto space = line.find(' ', begin);
  if (space == std::string::npos) throw std::runtime_error("'" + line + "' has no value");
  const auto word = line.substr(begin, space - begin);
  const auto value = line.substr(space + 1);
  if (is_field && !keys.empty()) return read_field(keys.back(), word, value);
  if (is_field || word != "key") throw std::runtime_error("'" + line + "' is neither a key nor a field of one");
  if (std::any_of(keys.begin(), keys.end(), [&](const Key& key) { return key.id == value; }))
    throw std::runtime_error("the key " + value + " is there twice");
  keys.emplace_back().id = value;
}

/// Throws for a key that lacks its secret, which no token could match, or its scopes, which would allow nothing.
void require_complete(const Key& key) {
  if (key.secret.digest.empty() || key.scopes.empty())
    throw std::runtime_error("the key " + key.id + " lacks its secret or its scopes");
}

}  // namespace

std::string write_keys(const std::vector<Key>& keys) {
  std::string text(heading);
  const auto line = [&](const char* field, const std::string& value) {
    text.append("  ").append(field).append(" ").append(value).append("\n");
  };
  for (const auto& key : keys) {
    text.append("key ").append(key.id).append("\n");
    line("name", key.name);
    line("scopes", scopes_text(key.scopes));
    line("secret", hash_text(key.secret));
    if (key.previous) {
      line("previous", hash_text(*key.previous));
      line("previous_until", time_text(key.previous_until));
    }
    line("created", time_text(key.created));
    if (key.expires) line("expires", time_text(key.expires));
    if (key.requests_per_minute) line("requests_per_minute", std::to_string(key.requests_per_minute));
    if (key.max_waiting_jobs) line("max_waiting_jobs", std::to_string(key.max_waiting_jobs));
    if (key.max_stored) line("max_stored", std::to_string(key.max_stored));
  }
  return text;
}

std::vector<Key> parse_keys(const std::string& text) {
  std::vector<Key> keys;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.empty() || line.starts_with('#')) continue;
    try {
      read_line(keys, line);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error("line " + std::to_string(number) + ": " + error.what());
    }
  }
  for (const auto& key : keys) require_complete(key);
  return keys;
}

}  // namespace supple::access
