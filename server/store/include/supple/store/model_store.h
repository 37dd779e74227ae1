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
#include <utility>
#include <vector>

#include "supple/design/candidates.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/model.h"
#include "supple/tiling/family.h"

namespace supple::store {

/// A model in memory. A computation can go on with it after its file has changed or gone.
struct LoadedModel {
  neural::Model model;
  neural::Evaluator evaluator;
  design::Candidates candidates;
  std::shared_ptr<const tiling::Family> family;
  /// The mark of its owner (`ModelStore::mark_of`); empty for a model of everyone.
  std::string owner{};
  std::string sha256;       ///< SHA-256 of the file, hexadecimal
  std::string description;  ///< the JSON that clients get
};

/// The models of a folder, which everyone sees, and of a second one, in which each file belongs to an owner. Their
/// files
/// "*.h5" are read at the start and again whenever they change.
///
/// One thread scans the folder every `period`, and compares inode numbers, sizes and times. It alone reads model files,
/// for HDF5 is not thread safe; helper processes parse them where there are any. A file that cannot be read is
/// reported, and is not read again until it changes; other models, and its own earlier version, stay available. A file
/// that changes while it is read is left to the next scan. Of two files with one id, the first by name is used. While
/// the folder itself cannot be read, the loaded models stay. Any thread may call.
class ModelStore {
 public:
  enum class Level { info, warning };
  struct Options {
    std::filesystem::path folder;  ///< of the models of everyone; empty or missing: none
    /// The folder of models that have an owner, whose mark is the beginning of the file's name:
    /// "0123456789abcdef-ID.h5". Empty or missing: none.
    std::filesystem::path own_folder{};
    std::chrono::milliseconds period{2000};
    std::int64_t max_file_bytes = 256LL << 20;  ///< bytes; larger files count as damaged; setting --max-model
    /// Time limit for reading one file, which takes effect only where a helper process reads. A file that takes longer
    /// is left out. It is generous, since a file is not damaged because the machine is busy: what computes for long
    /// is ended by a limit of CPU time.
    std::chrono::seconds max_read_time{600};
    /// Makes the description of a model. If it throws, the file counts as damaged. Called from the store's thread.
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

  /// The mark by which files name an owner: 16 hexadecimal digits.
  static std::string mark_of(const std::string& owner);
  /// The model of this id, if it is one of everyone or of this owner. Throws "model.not_found", which names the models
  /// that the owner sees.
  std::shared_ptr<const LoadedModel> get(const std::string& id, const std::string& owner = {}) const;
  /// All models of everyone and of this owner, in the order of their ids.
  std::vector<std::shared_ptr<const LoadedModel>> models(const std::string& owner = {}) const;
  std::size_t size() const;
  /// Number of files whose present version could not be read.
  std::size_t damaged() const;

 private:
  /// Properties of a file, of which any change of the file changes at least one.
  struct Stamp {
    std::uint64_t number = 0;   ///< inode number; a file that is renamed into place has another one
    std::int64_t size = 0;      ///< bytes
    std::int64_t modified = 0;  ///< ns
    std::int64_t changed = 0;   ///< ns, time of the last change of the status, which includes permissions
    bool operator==(const Stamp&) const = default;
  };
  struct File {
    Stamp stamp;                               ///< stamp at which the file was read last
    std::shared_ptr<const LoadedModel> model;  ///< null where no version of it could be read
    bool damaged = false;                      ///< whether its present version could not be read
  };
  using Models = std::map<std::string, std::shared_ptr<const LoadedModel>>;

  void run();
  bool is_ending() const;
  void scan();
  /// The stamps of the folder's model files by name; nullopt where the folder cannot be read.
  std::optional<std::map<std::string, Stamp>> list_files();
  /// The file of a name as `list_files` gives it.
  std::filesystem::path path_of(const std::string& name) const;
  static std::optional<Stamp> stamp_of(const std::filesystem::path& path);
  /// Reads a file. True if it was read or found damaged; false if it changed meanwhile.
  bool read(const std::string& name, const Stamp& stamp, File& file);
  /// Calls read() with a token that is cancelled after `max_read_time`, and when the store ends.
  neural::Model read_in_time(const std::function<neural::Model(const Execution&)>& read) const;
  void publish();

  const Options options_;
  // Only the thread uses these members.
  std::map<std::string, File> files_;
  std::set<std::string> reported_duplicates_;
  bool folder_error_reported_ = false;

  mutable std::mutex mutex_;
  mutable std::condition_variable wake_;
  Models models_;
  std::size_t damaged_ = 0;
  bool read_once_ = false;
  bool ending_ = false;
  std::thread thread_;
};

/// The models that an owner sees: those of everyone and its own.
class VisibleModels {
 public:
  /// `store` must outlive it.
  VisibleModels(const ModelStore& store, std::string owner) : store_(store), owner_(std::move(owner)) {}

  std::shared_ptr<const LoadedModel> get(const std::string& id) const { return store_.get(id, owner_); }
  std::vector<std::shared_ptr<const LoadedModel>> models() const { return store_.models(owner_); }

 private:
  const ModelStore& store_;
  const std::string owner_;
};

}  // namespace supple::store
