#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "supple/design/candidates.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/model.h"

namespace supple::store {

/// A model in memory. Who holds it may go on computing with it whatever becomes of its file.
struct LoadedModel {
  neural::Model model;
  neural::Evaluator evaluator;
  design::Candidates candidates;
  std::string sha256;       ///< of the file, hexadecimal
  std::string description;  ///< the JSON that clients get
};

/// The models of one folder: the files "*.h5" directly in it, read when the store is made and again whenever they
/// change.
///
/// One thread looks at the folder, every `period` by the files' numbers, sizes and times, and is the only one to read
/// model files, for HDF5 is not thread safe. Helper processes take them apart where there are any. A file that cannot
/// be read is reported with its reason, leaves all other models and its own earlier version served, and is not read
/// again until it changes. A file that changes while it is read counts at the next look. Where two files have one id,
/// the first by name is served. While the folder itself cannot be read, what was loaded stays. Any thread may call.
class ModelStore {
 public:
  enum class Level { info, warning };
  struct Options {
    std::filesystem::path folder;  ///< none where empty
    std::chrono::milliseconds period{2000};
    std::int64_t max_file = 256LL << 20;  ///< bytes; larger files count as damaged; setting --max-model
    std::chrono::seconds longest_read{
        60};  ///< where a helper process reads; a file that takes longer counts as damaged
    /// Makes the description; what it throws makes the file count as damaged. Called from the store's thread.
    std::function<std::string(const neural::Model&, const std::string& sha256)> describe;
    std::function<void(Level, const std::string&)> log;  ///< called from the store's thread
  };

  /// Starts the thread and returns at once.
  explicit ModelStore(Options options);
  /// Ends the thread, at the latest after the file that it is reading.
  ~ModelStore();
  ModelStore(const ModelStore&) = delete;
  ModelStore& operator=(const ModelStore&) = delete;

  /// Returns once the folder has been read for the first time.
  void wait_until_read() const;
  bool has_been_read() const;

  /// Throws "model.not_found", which names the models that there are.
  std::shared_ptr<const LoadedModel> get(const std::string& id) const;
  /// In the order of their ids.
  std::vector<std::shared_ptr<const LoadedModel>> models() const;
  std::size_t size() const;
  /// Files of which no present version could be read.
  std::size_t damaged() const;

 private:
  /// What a change of a file changes.
  struct Stamp {
    std::uint64_t number = 0;   ///< inode: a file that is renamed into place is another one
    std::int64_t size = 0;      ///< bytes
    std::int64_t modified = 0;  ///< ns
    std::int64_t changed = 0;   ///< ns, of the status: permissions count too
    bool operator==(const Stamp&) const = default;
  };
  struct File {
    Stamp stamp;                               ///< when it was read last
    std::shared_ptr<const LoadedModel> model;  ///< null where no version of it could be read
    bool damaged = false;                      ///< its present version
  };
  using Models = std::map<std::string, std::shared_ptr<const LoadedModel>>;

  void run();
  bool ending() const;
  void look();
  /// The files of the folder by name; nothing where the folder cannot be read.
  std::optional<std::map<std::string, Stamp>> list();
  static std::optional<Stamp> stamp_of(const std::filesystem::path& path);
  /// Whether the file was read or is known to be damaged; false where it changed meanwhile.
  bool read(const std::string& name, const Stamp& stamp, File& file);
  /// Calls read() with a token that stops it after the longest time that a file may take, and when the store ends.
  neural::Model read_in_time(const std::function<neural::Model(const Execution&)>& read) const;
  void serve();

  const Options options_;
  // Only the thread sees these.
  std::map<std::string, File> files_;
  std::set<std::string> reported_duplicates_;
  bool folder_reported_ = false;

  mutable std::mutex mutex_;
  mutable std::condition_variable wake_;
  Models models_;
  std::size_t damaged_ = 0;
  bool read_once_ = false;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace supple::store
