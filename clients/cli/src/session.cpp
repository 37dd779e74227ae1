#include "session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "failure.h"
#include "interrupt.h"
#include "job_news.h"
#include "progress_bar.h"
#include "style.h"

namespace supple::cli {
namespace {

/// Length of an id, which is a SHA-256 in hexadecimal.
constexpr std::size_t full_id_length = 64;
/// The Prefer header for an answer within one second; a longer computation becomes a job.
constexpr auto prefer_immediate = "wait=1";
constexpr auto min_poll_interval = std::chrono::milliseconds(50);
constexpr auto max_poll_interval = std::chrono::milliseconds(1000);

[[noreturn]] void throw_interrupted(const std::string& what) { throw Failure(ExitCode::interrupted, what); }

bool is_file(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

[[noreturn]] void throw_unreadable(const std::string& path) {
  const int error = errno;
  std::error_code ignored;
  std::string why = std::generic_category().message(error);
  if (!std::filesystem::exists(path, ignored)) why = "no such file";
  if (std::filesystem::is_directory(path, ignored)) why = "it is a folder";
  throw Failure(ExitCode::local_file, fmt::format("{} cannot be read: {}", path, why));
}

[[noreturn]] void throw_unwritable(const std::string& path) {
  const int error = errno;
  std::error_code ignored;
  const auto folder = std::filesystem::path(path).parent_path();
  std::string why = std::generic_category().message(error);
  if (!folder.empty() && !std::filesystem::exists(folder, ignored))
    why = fmt::format("no such folder: {}", folder.string());
  if (std::filesystem::is_directory(path, ignored)) why = "it is a folder";
  throw Failure(ExitCode::local_file, fmt::format("{} cannot be written: {}", path, why));
}

/// Sleeps until the time has passed or Ctrl-C was pressed.
void pause(std::chrono::milliseconds duration) {
  const auto end = std::chrono::steady_clock::now() + duration;
  while (!InterruptWatch::interrupted() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::min(duration, std::chrono::milliseconds(20)));
  }
}

}  // namespace

std::string Session::mesh_id(const std::string& mesh) {
  if (is_file(mesh)) {
    const nlohmann::json added = http_.post("/v1/meshes", read_file(mesh), "application/octet-stream").json();
    // Warnings must be shown: for example, on a surface with cracks distances differ from those that the user expects.
    for (const auto& warning : added.at("warnings")) print_notice(mesh + ": " + warning.get<std::string>());
    return added.at("id").get<std::string>();
  }
  const bool hexadecimal = mesh.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (mesh.size() == full_id_length && hexadecimal) return mesh;
  if (mesh.empty() || !hexadecimal) {
    if (looks_like_path(mesh)) throw_unreadable(mesh);
    throw Failure(ExitCode::usage, fmt::format("'{}' is neither a mesh file nor the id of a mesh: no such file", mesh));
  }
  std::vector<std::string> fitting;
  for_each_entry("/v1/meshes", "meshes", [&](const nlohmann::json& entry) {
    if (auto id = entry.at("id").get<std::string>(); id.starts_with(mesh)) fitting.push_back(std::move(id));
  });
  if (fitting.size() == 1) return fitting.front();
  if (fitting.empty()) {
    throw Failure(ExitCode::rejected, fmt::format("no mesh of {} has an id that begins with '{}'", http_.url(), mesh));
  }
  throw Failure(ExitCode::usage,
                fmt::format("'{}' begins the ids of {} meshes; write more of it", mesh, fitting.size()));
}

void Session::for_each_entry(const std::string& path, const char* key,
                             const std::function<void(const nlohmann::json&)>& visit) {
  std::string page = path;
  while (true) {
    const nlohmann::json document = http_.get(page).json();
    for (const auto& entry : document.at(key)) visit(entry);
    const auto next = document.find("next");
    if (next == document.end()) return;
    page = fmt::format("{}{}after={}", path, path.find('?') == std::string::npos ? '?' : '&', next->get<std::string>());
  }
}

Answer Session::compute(const std::string& path, nlohmann::json request, const std::string& accept) {
  if (!options_.priority.empty()) request["priority"] = options_.priority;
  // Between the answer and the first poll of the job, an interrupt is only recorded.
  const InterruptWatch::Scope quiet([] {});
  Answer answer;
  try {
    // An interrupt closes the connection, which cancels an immediate computation on the server.
    const InterruptWatch::Scope scope([this] { http_.abort(); });
    answer = http_.post(path, request.dump(), "application/json", accept, prefer_immediate);
  } catch (const Failure&) {
    if (InterruptWatch::interrupted()) throw_interrupted("interrupted; the computation was cancelled");
    throw;
  }
  if (answer.status != 202) {
    if (InterruptWatch::interrupted()) throw_interrupted("interrupted");
    return answer;
  }
  return follow(answer.location, accept, /*cancel_on_interrupt=*/true);
}

Answer Session::follow(const std::string& job_path, const std::string& accept, bool cancel_on_interrupt) {
  // The polling loop checks for interrupts itself, so that nothing needs to be aborted.
  const InterruptWatch::Scope scope([] {});
  ProgressBar bar(!options_.no_progress);
  PolishRounds rounds;
  auto interval = min_poll_interval;
  while (true) {
    const nlohmann::json job = http_.get(job_path).json();
    const auto state = job.at("state").get<std::string>();
    if (observer_) observer_(job);
    if (state != "accepted" && state != "running") break;
    if (const auto round = rounds.add(job); !round.empty()) bar.print_above(round);
    const auto best = rounds.best();
    bar.show(job.at("progress").get<double>(), remaining_seconds_of(job),
             best.empty() ? stage_of(job) : stage_of(job) + ", " + best);
    pause(interval);
    interval = std::min(2 * interval, max_poll_interval);
    if (InterruptWatch::interrupted()) {
      if (!cancel_on_interrupt) throw_interrupted("interrupted; the job goes on");
      http_.erase(job_path);
      throw_interrupted("interrupted; the job was cancelled");
    }
  }
  return http_.get(job_path + "/result", accept);
}

void print_json(const nlohmann::json& document) { fmt::print("{}\n", document.dump(2)); }

bool looks_like_path(const std::string& text) {
  if (text.find_first_of(",;") != std::string::npos) return false;
  if (text.find('/') != std::string::npos) return true;
  const auto letter = [](unsigned char c) { return c < 0x80 && std::isalpha(c) != 0; };
  const auto ending = std::filesystem::path(text).extension().string();
  return ending.size() > 1 && letter(static_cast<unsigned char>(ending[1]));
}

std::string read_file(const std::string& path) {
  if (std::error_code ignored; std::filesystem::is_directory(path, ignored)) throw_unreadable(path);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file) throw_unreadable(path);
  return content;
}

nlohmann::json object_in_file(const std::string& path) {
  auto object = nlohmann::json::parse(read_file(path), nullptr, /*allow_exceptions=*/false);
  if (!object.is_object()) throw Failure(ExitCode::local_file, fmt::format("{} holds no JSON object", path));
  return object;
}

void write_file(const std::string& path, const std::string& content) {
  if (path == "-") {
    std::cout.write(content.data(), static_cast<std::streamsize>(content.size())).flush();
    return;
  }
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  if (!file) throw_unwritable(path);
}

void replace_file(const std::string& path, const std::string& content) {
  const std::string part = path + ".part";
  write_file(part, content);
  std::error_code failed;
  std::filesystem::rename(part, path, failed);
  if (failed) throw Failure(ExitCode::local_file, fmt::format("{} cannot be written: {}", path, failed.message()));
}

}  // namespace supple::cli
