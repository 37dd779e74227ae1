#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "http_client.h"
#include "key.h"

namespace supple::cli {

/// The options of all commands.
struct GlobalOptions {
  std::string server = "http://127.0.0.1:8080";
  std::string key;           ///< key that requests carry; may be empty
  std::string key_file;      ///< file with the key, if `key` is empty
  bool json = false;         ///< whether the server's answers are printed unchanged
  bool no_progress = false;  ///< whether no progress bar is drawn
  std::string priority;      ///< priority of computations; empty leaves it to the server
};

/// One run of the program: the options and the connection that its commands share.
class Session {
 public:
  explicit Session(const GlobalOptions& options)
      : options_(options), http_(options.server, find_key(options.key, options.key_file)) {}

  HttpClient& http() { return http_; }
  bool json() const { return options_.json; }

  /// The id of a mesh. `mesh` is its id, the beginning of the id of only one of the server's meshes, or a mesh file,
  /// which is uploaded (equal content is stored once). Throws Failure.
  std::string mesh_id(const std::string& mesh);

  /// Calls `visit` for each entry of a list that the server sends in pages; `key` is the name of the array.
  void for_each_entry(const std::string& path, const char* key,
                      const std::function<void(const nlohmann::json&)>& visit);

  /// Runs a computation and waits for its result, which it returns in the media type `accept`.
  ///
  /// The server answers within the first second or creates a job, which is then followed with a progress bar. Ctrl-C
  /// cancels the computation on the server and throws Failure(interrupted).
  Answer compute(const std::string& path, nlohmann::json request, const std::string& accept = "application/json");

  /// Sets a function that is called with the server's description of a job whenever `follow` polls it.
  void set_observer(std::function<void(const nlohmann::json& job)> observer) { observer_ = std::move(observer); }

  /// Follows a job to its end and returns its result. Ctrl-C throws Failure(interrupted), and cancels the job if
  /// `cancel_on_interrupt`.
  Answer follow(const std::string& job_path, const std::string& accept, bool cancel_on_interrupt);

 private:
  GlobalOptions options_;
  HttpClient http_;
  std::function<void(const nlohmann::json&)> observer_;
};

/// Prints a server's answer as JSON.
void print_json(const nlohmann::json& document);
/// Whether a text is surely the name of a file, since it has a folder or an extension, such as "curves/target.csv".
bool looks_like_path(const std::string& text);
/// The content of a file. Throws Failure(local_file) that says why it cannot be read, for example "no such file".
std::string read_file(const std::string& path);
/// The JSON object in a file. Throws Failure(local_file).
nlohmann::json object_in_file(const std::string& path);
/// Writes to a file, or to standard output if the path is "-". Throws Failure(local_file).
void write_file(const std::string& path, const std::string& content);
/// Replaces a file atomically: the old one is unchanged until the new one is complete. Throws Failure(local_file).
void replace_file(const std::string& path, const std::string& content);

}  // namespace supple::cli
