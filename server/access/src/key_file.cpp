#include "supple/access/key_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "supple/access/duration.h"

namespace supple::access {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& action, const fs::path& path) {
  throw std::runtime_error("cannot " + action + " " + path.string() + ": " + std::generic_category().message(errno));
}

class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags, const char* action) : value_(::open(path.c_str(), flags, 0600)) {
    if (value_ < 0) fail(action, path);
  }
  ~Descriptor() { ::close(value_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return value_; }

 private:
  int value_;
};

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

void make_folder(const fs::path& folder) {
  if (fs::exists(folder)) return;
  fs::create_directories(folder);
  fs::permissions(folder, fs::perms::owner_all);
}

/// So that the server, which seldom runs as root, can read what root has written.
void leave_to_owner_of(const fs::path& folder, const Descriptor& file, const fs::path& path) {
  struct stat status {};
  if (::geteuid() != 0 || ::stat(folder.c_str(), &status) != 0 || status.st_uid == 0) return;
  if (::fchown(file.get(), status.st_uid, status.st_gid) != 0) fail("change the owner of", path);
}

void write_all(const Descriptor& file, std::string_view bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const auto count = ::write(file.get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("write", path);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  if (::fsync(file.get()) != 0) fail("synchronize", path);
}

/// Under the folder's lock, so that the name of the half-written file is free.
void replace_file(const fs::path& path, const Descriptor& folder, std::string_view bytes) {
  auto part = path;
  part += ".part";
  try {
    const Descriptor file(part, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, "create");
    if (::fchmod(file.get(), 0600) != 0) fail("change the mode of", part);
    leave_to_owner_of(folder_of(path), file, part);
    write_all(file, bytes, part);
    if (::rename(part.c_str(), path.c_str()) != 0) fail("replace", path);
  } catch (...) {
    ::unlink(part.c_str());
    throw;
  }
  if (::fsync(folder.get()) != 0) fail("synchronize", folder_of(path));
}

Key& find_key(std::vector<Key>& keys, const std::string& id) {
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.id == id; });
  if (found == keys.end()) throw std::runtime_error("there is no key '" + id + "'; \"keys list\" shows all of them");
  return *found;
}

void check_name(const std::vector<Key>& keys, const std::string& name) {
  constexpr std::size_t longest = 64;
  const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) { return c >= 0x20 && c < 0x7f; });
  if (name.empty() || name.size() > longest || !plain)
    throw std::runtime_error("the name of a key has 1 to 64 printable characters of ASCII");
  const auto same = std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
  if (same != keys.end()) {
    throw std::runtime_error("the key " + same->id + " has the name '" + name +
                             "' already; rotate it, revoke it, or take another name");
  }
}

}  // namespace

bool KeyFile::exists() const { return fs::exists(path_); }

std::vector<Key> KeyFile::read() const {
  if (!exists()) return {};
  const Descriptor file(path_, O_RDONLY | O_CLOEXEC, "read");
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) fail("read", path_);
  if (!S_ISREG(status.st_mode)) throw std::runtime_error("the key file " + path_.string() + " is no regular file");
  if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
    throw std::runtime_error("the key file " + path_.string() +
                             " may be written by others than its user: chmod 600 changes that");
  }
  std::string text;
  std::array<char, 4096> piece;
  while (const auto count = ::read(file.get(), piece.data(), piece.size())) {
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("read", path_);
    text.append(piece.data(), static_cast<std::size_t>(count));
  }
  try {
    return parse_keys(text);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("the key file " + path_.string() + " is not understood, " + error.what());
  }
}

void KeyFile::change(const std::function<void(std::vector<Key>&)>& edit) const {
  const auto folder_path = folder_of(path_);
  make_folder(folder_path);
  const Descriptor folder(folder_path, O_RDONLY | O_DIRECTORY | O_CLOEXEC, "open");
  while (::flock(folder.get(), LOCK_EX) != 0)
    if (errno != EINTR) fail("lock", folder_path);
  auto keys = read();
  edit(keys);
  replace_file(path_, folder, write_keys(keys));
}

Token add_key(std::vector<Key>& keys, const NewKey& wanted, std::int64_t now) {
  check_name(keys, wanted.name);
  Token token{new_key_id(), new_secret()};
  Key key;
  key.id = token.id;
  key.name = wanted.name;
  key.scopes = wanted.scopes;
  key.secret = hash_secret(token.secret);
  key.created = now;
  key.expires = wanted.expires_in ? now + wanted.expires_in : 0;
  key.requests_per_minute = wanted.requests_per_minute;
  key.max_waiting_jobs = wanted.max_waiting_jobs;
  keys.push_back(std::move(key));
  return token;
}

Token rotate_key(std::vector<Key>& keys, const std::string& id, std::int64_t overlap, std::int64_t now) {
  auto& key = find_key(keys, id);
  if (key.expires && key.expires <= now)
    throw std::runtime_error("the key " + id + " has expired on " + time_text(key.expires) + "; add another one");
  key.previous.reset();
  key.previous_until = 0;
  if (overlap > 0) {
    key.previous = key.secret;
    key.previous_until = now + overlap;
  }
  Token token{id, new_secret()};
  key.secret = hash_secret(token.secret);
  return token;
}

void revoke_key(std::vector<Key>& keys, const std::string& id) {
  const auto& key = find_key(keys, id);
  keys.erase(keys.begin() + (&key - keys.data()));
}

}  // namespace supple::access
