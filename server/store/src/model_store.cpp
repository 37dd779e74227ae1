#include "supple/store/model_store.h"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <thread>

#include "supple/base/error.h"
#include "supple/store/store.h"
#include "supple/store/store_error.h"
#include "supple/tiling/definition_text.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view suffix = ".h5";
/// Names of files of the folder with owners begin with it here.
constexpr std::string_view own_prefix = "own/";
constexpr std::size_t mark_digits = 16;

/// The mark of the owner of a file of that folder; nullopt for a name without one.
std::optional<std::string> mark_in(std::string_view name) {
  if (!name.starts_with(own_prefix)) return std::string();
  name.remove_prefix(own_prefix.size());
  const auto mark = name.substr(0, mark_digits);
  if (name.size() <= mark_digits || name[mark_digits] != '-' ||
      mark.find_first_not_of("0123456789abcdef") != std::string_view::npos)
    return std::nullopt;
  return std::string(mark);
}

std::int64_t nanoseconds(const timespec& time) { return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec; }

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file) throw Error("file.unreadable", "The file cannot be read.");
  return bytes;
}

/// The family whose structures a model's designs are. Throws where there is none, or one with other parameters.
std::shared_ptr<const tiling::Family> family_of(const neural::Model& model) {
  auto family = tiling::family_of(model.family, model.definition);
  if (family->parameters.size() != static_cast<std::size_t>(model.network.shape.parameters))
    throw Error("file.unreadable", "Its family " + model.family + " has " + std::to_string(family->parameters.size()) +
                                       " parameters, and its network has " +
                                       std::to_string(model.network.shape.parameters) + ".");
  return family;
}

}  // namespace

ModelStore::ModelStore(Options options) : options_(std::move(options)) {
  thread_ = std::thread([this] { run(); });
}

ModelStore::~ModelStore() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void ModelStore::wait_until_read() const {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [this] { return read_once_; });
}

bool ModelStore::has_been_read() const {
  const std::lock_guard lock(mutex_);
  return read_once_;
}

std::string ModelStore::mark_of(const std::string& owner) { return sha256(owner).substr(0, mark_digits); }

std::shared_ptr<const LoadedModel> ModelStore::get(const std::string& id, const std::string& owner) const {
  const auto mark = mark_of(owner);
  const std::lock_guard lock(mutex_);
  const auto is_visible = [&](const LoadedModel& model) { return model.owner.empty() || model.owner == mark; };
  if (const auto found = models_.find(id); found != models_.end() && is_visible(*found->second)) return found->second;
  std::string known;
  for (const auto& [name, model] : models_)
    if (is_visible(*model)) known += (known.empty() ? "" : ", ") + name;
  throw ModelNotFound(id.substr(0, 80), known.empty() ? "no model is loaded." : "known are " + known + ".");
}

std::vector<std::shared_ptr<const LoadedModel>> ModelStore::models(const std::string& owner) const {
  const auto mark = mark_of(owner);
  const std::lock_guard lock(mutex_);
  std::vector<std::shared_ptr<const LoadedModel>> visible;
  for (const auto& [id, model] : models_)
    if (model->owner.empty() || model->owner == mark) visible.push_back(model);
  return visible;
}

std::size_t ModelStore::size() const {
  const std::lock_guard lock(mutex_);
  return models_.size();
}

std::size_t ModelStore::damaged() const {
  const std::lock_guard lock(mutex_);
  return damaged_;
}

void ModelStore::run() {
  while (true) {
    try {
      scan();
    } catch (const std::exception& error) {
      // There may be too little memory, for example. The loaded models stay, and the next scan tries again.
      options_.log(Level::warning, std::string("the folder of models was not read to its end: ") + error.what());
    } catch (...) {
      options_.log(Level::warning, "the folder of models was not read to its end");
    }
    std::unique_lock lock(mutex_);
    if (!read_once_) {
      read_once_ = true;
      wake_.notify_all();
    }
    // Without a folder there is nothing to scan for.
    if (options_.folder.empty() && options_.own_folder.empty()) wake_.wait(lock, [this] { return ending_; });
    if (wake_.wait_for(lock, options_.period, [this] { return ending_; })) return;
  }
}

bool ModelStore::is_ending() const {
  const std::lock_guard lock(mutex_);
  return ending_;
}

void ModelStore::scan() {
  if (options_.folder.empty() && options_.own_folder.empty()) return;
  const auto found = list_files();
  if (!found) return;
  bool changed = false;
  for (auto file = files_.begin(); file != files_.end();) {
    if (found->contains(file->first)) {
      ++file;
      continue;
    }
    if (file->second.model) options_.log(Level::info, "model file " + file->first + " is gone");
    file = files_.erase(file);
    changed = true;
  }
  for (const auto& [name, stamp] : *found) {
    if (is_ending()) return;
    const auto known = files_.find(name);
    if (known != files_.end() && known->second.stamp == stamp) continue;
    File file;
    if (known != files_.end()) file.model = known->second.model;
    if (!read(name, stamp, file)) continue;
    files_[name] = std::move(file);
    changed = true;
  }
  if (changed) publish();
}

std::optional<std::map<std::string, ModelStore::Stamp>> ModelStore::list_files() {
  std::map<std::string, Stamp> found;
  std::error_code error;
  const auto list = [&](const fs::path& folder, std::string_view prefix, std::error_code& fault) {
    for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end; entry.increment(fault)) {
      const auto& path = entry->path();
      if (path.extension() != suffix) continue;
      if (const auto stamp = stamp_of(path)) found.emplace(std::string(prefix) + path.filename().string(), *stamp);
    }
  };
  if (!options_.folder.empty()) list(options_.folder, "", error);
  std::error_code own_error;
  if (!options_.own_folder.empty()) list(options_.own_folder, own_prefix, own_error);
  // The folder appears with the first model that has an owner.
  if (own_error && own_error != std::errc::no_such_file_or_directory && !error) error = own_error;
  if (error && !folder_error_reported_) {
    options_.log(Level::warning, "the folder of models " + options_.folder.string() +
                                     " cannot be read, and what was loaded stays: " + error.message());
  }
  folder_error_reported_ = static_cast<bool>(error);
  if (error) return std::nullopt;
  return found;
}

std::optional<ModelStore::Stamp> ModelStore::stamp_of(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return Stamp{status.st_ino, status.st_size, nanoseconds(status.st_mtim), nanoseconds(status.st_ctim)};
}

fs::path ModelStore::path_of(const std::string& name) const {
  return name.starts_with(own_prefix) ? options_.own_folder / name.substr(own_prefix.size()) : options_.folder / name;
}

bool ModelStore::read(const std::string& name, const Stamp& stamp, File& file) {
  const auto path = path_of(name);
  std::shared_ptr<const LoadedModel> loaded;
  std::string reason;
  try {
    if (stamp.size > options_.max_file_bytes) {
      throw Error("file.unreadable", "it has " + std::to_string(stamp.size) + " bytes, the limit is " +
                                         std::to_string(options_.max_file_bytes) + " (setting --max-model)");
    }
    const auto owner = mark_in(name);
    if (!owner) throw Error("file.unreadable", "its name does not begin with the mark of an owner");
    const std::string bytes = content(path);
    auto hash = sha256(bytes);
    auto model =
        read_in_time([&](const Execution& execution) { return neural::read_model(bytes, path.string(), execution); });
    auto family = family_of(model);
    auto description = options_.describe(model, hash);
    neural::Evaluator evaluator(model.network);
    design::Candidates candidates(model.network);
    loaded = std::make_shared<const LoadedModel>(LoadedModel{std::move(model), std::move(evaluator),
                                                             std::move(candidates), std::move(family), *owner,
                                                             std::move(hash), std::move(description)});
  } catch (const Cancelled&) {
    return false;  // the server ends, which says nothing about the file
  } catch (const std::exception& error) {
    // A damaged file may ask for any amount of memory, so that a lack of memory counts as a fault of the file.
    reason = error.what();
  }
  // The file changed while it was read: it may have been half-written, or its hash may be that of other bytes than its
  // model's.
  if (stamp_of(path) != std::optional(stamp)) return false;
  file.stamp = stamp;
  file.damaged = !loaded;
  if (loaded) {
    options_.log(Level::info, "model " + loaded->model.id + " read from " + name);
    file.model = std::move(loaded);
  } else {
    options_.log(Level::warning, "model file " + name + " is left out" +
                                     (file.model ? ", its earlier version stays: " : ": ") + reason);
  }
  return true;
}

neural::Model ModelStore::read_in_time(const std::function<neural::Model(const Execution&)>& read) const {
  const Execution execution;
  bool done = false;
  std::thread watch([&] {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, options_.max_read_time, [&] { return done || ending_; });
    if (!done) execution.cancellation.request(ending_ ? StopReason::shutdown : StopReason::deadline);
  });
  struct JoinAtEnd {
    const ModelStore& store;
    bool& done;
    std::thread& watch;
    ~JoinAtEnd() {
      {
        const std::lock_guard lock(store.mutex_);
        done = true;
      }
      store.wake_.notify_all();
      watch.join();
    }
  } const join{*this, done, watch};
  try {
    return read(execution);
  } catch (const Cancelled& stop) {
    if (stop.reason() != StopReason::deadline) throw;
    throw Error("file.unreadable", "it was not read within " + std::to_string(options_.max_read_time.count()) + " s");
  }
}

void ModelStore::publish() {
  Models models;
  std::set<std::string> duplicates;
  std::map<std::string, std::string> owners;
  for (const auto& [name, file] : files_) {
    if (!file.model) continue;
    const auto& id = file.model->model.id;
    if (models.emplace(id, file.model).second) {
      owners.emplace(id, name);
      continue;
    }
    std::string text = "model file ";
    text.append(name).append(" is left out: ").append(owners[id]).append(" has the id ").append(id).append(" too");
    if (!reported_duplicates_.contains(text)) options_.log(Level::warning, text);
    duplicates.insert(std::move(text));
  }
  reported_duplicates_ = std::move(duplicates);
  const auto damaged =
      std::count_if(files_.begin(), files_.end(), [](const auto& file) { return file.second.damaged; });
  const std::lock_guard lock(mutex_);
  models_.swap(models);
  damaged_ = static_cast<std::size_t>(damaged);
}

}  // namespace supple::store
