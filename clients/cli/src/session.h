#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "http_client.h"
#include "key.h"

namespace supple::cli {

/// What the options before the command say.
struct GlobalOptions {
  std::string server = "http://127.0.0.1:8080";
  std::string key;           ///< that is sent along; none where empty
  std::string key_file;      ///< holds the key where `key` is empty
  bool json = false;         ///< print the server's answers unchanged
  bool no_progress = false;  ///< never draw a progress bar
};

/// One run of the program: the options and the connection that its commands share.
class Session {
 public:
  explicit Session(const GlobalOptions& options)
      : options_(options), http_(options.server, find_key(options.key, options.key_file)) {}

  HttpClient& http() { return http_; }
  bool json() const { return options_.json; }

  /// The id of a mesh given as its id, as the beginning of an id that fits one mesh of the server only, or as a mesh
  /// file, which is uploaded (once: equal content is one mesh). Throws Failure.
  std::string mesh_id(const std::string& mesh);

  /// Calls `visit` for each entry of a list that the server gives page by page; `key` names the array.
  void for_each_entry(const std::string& path, const char* key,
                      const std::function<void(const nlohmann::json&)>& visit);

  /// Runs a computation and waits for its result, which it returns in the media type `accept`.
  ///
  /// The server answers within the first second or hands out a job, which is then followed with a progress bar. Ctrl-C
  /// cancels the computation on the server and throws Failure(interrupted).
  Answer compute(const std::string& path, const nlohmann::json& request,
                 const std::string& accept = "application/json");

  /// Is shown a job that is followed, as the server describes it, each time it is looked at.
  void set_observer(std::function<void(const nlohmann::json& job)> observer) { observer_ = std::move(observer); }

  /// Follows a job to its end and returns its result. Ctrl-C cancels the job where `cancel_on_interrupt`, and otherwise
  /// merely stops looking.
  Answer follow(const std::string& job_path, const std::string& accept, bool cancel_on_interrupt);

 private:
  GlobalOptions options_;
  HttpClient http_;
  std::function<void(const nlohmann::json&)> observer_;
};

/// Prints a server's answer for programs.
void print_json(const nlohmann::json& document);
/// Whether a text can only be meant as the name of a file: it has a folder or an ending, such as "curves/target.csv".
bool looks_like_path(const std::string& text);
/// The content of a file. Throws Failure(local_file) that says why it cannot be read, for example "no such file".
std::string read_file(const std::string& path);
/// Writes a file, or standard output where the path is "-". Throws Failure(local_file).
void write_file(const std::string& path, const std::string& content);
/// Puts a file in the place of an older one, which stays as it is until the new one is complete. Throws
/// Failure(local_file).
void replace_file(const std::string& path, const std::string& content);

}  // namespace supple::cli
