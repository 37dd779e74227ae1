#include "record_file.h"

#include <algorithm>
#include <charconv>

#include "supple/store/store.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

constexpr std::string_view format_version = " 2\n";
constexpr std::string_view header_hash_name = "header-sha256: ";
constexpr std::string_view response_header_prefix = "header ";
constexpr std::string_view query_prefix = "query ";

/// Escapes line ends, which end a value, and in a name also colons, which end the name.
std::string escaped(std::string_view text, bool is_name = false) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) {
    if (c == '\\') {
      result += "\\\\";
    } else if (c == '\n') {
      result += "\\n";
    } else if (c == ':' && is_name) {
      result += "\\c";
    } else {
      result += c;
    }
  }
  return result;
}

std::string unescaped(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      result += text[i];
      continue;
    }
    ++i;
    result += text[i] == 'n' ? '\n' : text[i] == 'c' ? ':' : text[i];
  }
  return result;
}

std::string number_text(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

/// A number of a header, which needs no check: the hash of the header is right.
template <class Number>
Number number(std::string_view text) {
  Number value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

void add_job(RecordFile& file, const JobRecord& job) {
  file.add("id", job.id)
      .add("kind", job.kind)
      .add("mesh", job.mesh)
      .add("state", state_name(job.state))
      .add("created", job.created)
      .add("started", job.started)
      .add("finished", job.finished)
      .add("expires", job.expires)
      .add("deadline", number_text(job.deadline))
      .add("client", job.client)
      .add("session", job.session)
      .add("owner", job.owner)
      .add("attempts", std::int64_t{job.attempts})
      .add("error", job.error)
      .add("error-status", std::int64_t{job.error_status});
  if (job.priority != Priority::normal) file.add("priority", priority_name(job.priority));
  if (job.idempotency_key.empty()) return;
  file.add("idempotency-key", job.idempotency_key).add("request-hash", job.request_hash);
}

}  // namespace

RecordFile& RecordFile::add(std::string_view name, std::string_view value) {
  fields_.emplace_back(name, value);
  return *this;
}

std::string RecordFile::header(const std::string& body_hash) const {
  std::string lines;
  for (const auto& [name, text] : fields_) {
    lines.append(escaped(name, true)).append(": ").append(escaped(text)).append("\n");
  }
  lines.append(body_hash_name).append(": ").append(body_hash).append("\n");
  std::string all = kind_;
  all.append(format_version).append(header_hash_name).append(sha256(lines)).append("\n").append(lines).append("\n");
  return all;
}

std::string_view RecordFile::value(std::string_view name) const {
  const auto found = std::find_if(fields_.begin(), fields_.end(), [name](const auto& f) { return f.first == name; });
  return found == fields_.end() ? std::string_view() : std::string_view(found->second);
}

std::int64_t RecordFile::integer(std::string_view name) const { return number<std::int64_t>(value(name)); }

bool RecordFile::starts_with_header(std::string_view kind, std::string_view bytes) {
  return bytes.starts_with(kind) && bytes.substr(kind.size()).starts_with(format_version) &&
         bytes.substr(kind.size() + format_version.size()).starts_with(header_hash_name);
}

RecordFile RecordFile::parse(std::string_view kind, std::string_view bytes, const std::string& name) {
  if (!starts_with_header(kind, bytes)) throw_corrupted(name);
  RecordFile file(kind);
  const auto hash_begin = kind.size() + format_version.size() + header_hash_name.size();
  const auto lines_begin = bytes.find('\n', hash_begin);
  if (lines_begin == std::string_view::npos) throw_corrupted(name);
  const auto lines_end = bytes.find("\n\n", lines_begin);
  if (lines_end == std::string_view::npos) throw_corrupted(name);
  const auto lines = bytes.substr(lines_begin + 1, lines_end - lines_begin);
  if (sha256(lines) != bytes.substr(hash_begin, lines_begin - hash_begin)) throw_corrupted(name);
  for (std::size_t begin = 0; begin < lines.size();) {
    const auto end = lines.find('\n', begin);
    const auto line = lines.substr(begin, end - begin);
    const auto colon = line.find(": ");
    if (colon == std::string_view::npos) throw_corrupted(name);
    file.add(unescaped(line.substr(0, colon)), unescaped(line.substr(colon + 2)));
    begin = end + 1;
  }
  file.header_size_ = lines_end + 2;
  return file;
}

RecordFile result_file(const JobRecord& job, const Result& result) {
  RecordFile file(result_kind);
  add_job(file, job);
  file.add("content-type", result.content_type);
  for (const auto& [name, value] : result.headers) file.add(std::string(response_header_prefix) + name, value);
  return file;
}

RecordFile request_file(const JobRecord& job, const JobRequest& request) {
  RecordFile file(request_kind);
  add_job(file, job);
  file.add("method", request.method).add("path", request.path);
  for (const auto& [name, value] : request.query) file.add(std::string(query_prefix) + name, value);
  file.add("content-type", request.content_type).add("accept", request.accept);
  return file;
}

JobRecord job_of(const RecordFile& file) {
  JobRecord job;
  job.id = file.value("id");
  job.kind = file.value("kind");
  job.mesh = file.value("mesh");
  const auto state = state_of(file.value("state"));
  if (!state) throw_corrupted(job.id);
  job.state = *state;
  job.created = file.integer("created");
  job.started = file.integer("started");
  job.finished = file.integer("finished");
  job.expires = file.integer("expires");
  job.deadline = number<double>(file.value("deadline"));
  job.client = file.value("client");
  job.session = file.value("session");
  job.owner = file.value("owner");
  job.attempts = static_cast<int>(file.integer("attempts"));
  job.error = file.value("error");
  job.error_status = static_cast<int>(file.integer("error-status"));
  job.idempotency_key = file.value("idempotency-key");
  job.request_hash = file.value("request-hash");
  job.priority = priority_of(file.value("priority")).value_or(Priority::normal);  // files name no normal one
  return job;
}

Result result_of(const RecordFile& file) {
  Result result;
  result.content_type = file.value("content-type");
  for (const auto& [name, value] : file.fields()) {
    if (name.starts_with(response_header_prefix))
      result.headers.emplace_back(name.substr(response_header_prefix.size()), value);
  }
  return result;
}

JobRequest request_of(const RecordFile& file) {
  JobRequest request;
  request.method = file.value("method");
  request.path = file.value("path");
  for (const auto& [name, value] : file.fields()) {
    if (name.starts_with(query_prefix)) request.query.emplace(name.substr(query_prefix.size()), value);
  }
  request.content_type = file.value("content-type");
  request.accept = file.value("accept");
  return request;
}

StoredRequest stored_request(std::string bytes, const std::string& name) {
  const auto file = RecordFile::parse(request_kind, bytes, name);
  bytes.erase(0, file.header_size());
  if (sha256(bytes) != file.body_hash()) throw_corrupted(name);
  return {request_of(file), std::move(bytes)};
}

std::size_t body_offset(std::string_view kind, std::string_view bytes, const std::string& name) {
  return RecordFile::starts_with_header(kind, bytes) ? RecordFile::parse(kind, bytes, name).header_size() : 0;
}

void throw_corrupted(const std::string& name) {
  throw StoreCorrupted("The stored file " + name + " has changed since it was written.");
}

void throw_missing(const std::string& name) { throw StoreCorrupted(missing_file_message(name)); }

std::string missing_file_message(const std::string& name) { return "The stored file " + name + " is missing."; }

std::string join_headers(const Result& result) {
  std::string text;
  for (const auto& [name, value] : result.headers) text.append(name).append(": ").append(value).append("\n");
  return text;
}

void split_headers(const std::string& text, Result& result) {
  std::size_t begin = 0;
  while (begin < text.size()) {
    const auto end = text.find('\n', begin);
    const auto colon = text.find(": ", begin);
    result.headers.emplace_back(text.substr(begin, colon - begin), text.substr(colon + 2, end - colon - 2));
    begin = end + 1;
  }
}

}  // namespace supple::store
