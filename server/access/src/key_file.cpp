#include "supple/access/key_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>

#include "supple/access/duration.h"
#include "supple/base/durable_file.h"

namespace supple::access {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

void make_folder(const fs::path& folder) {
  if (fs::exists(folder)) return;
  fs::create_directories(folder);
  fs::permissions(folder, fs::perms::owner_all);
}

/// Gives a file that root has written to the owner of the folder, because the server rarely runs as root.
void give_to_owner_of(const fs::path& folder, int file, const fs::path& path) {
  struct stat status {};
  if (::geteuid() != 0 || ::stat(folder.c_str(), &status) != 0 || status.st_uid == 0) return;
  if (::fchown(file, status.st_uid, status.st_gid) != 0) throw FileError("change the owner of", path, errno);
}

Key& find_key(std::vector<Key>& keys, const std::string& id) {
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.id == id; });
  if (found == keys.end()) throw std::runtime_error("there is no key '" + id + "'; \"keys list\" shows all of them");
  return *found;
}

void check_name(const std::vector<Key>& keys, const std::string& name) {
  constexpr std::size_t max_length = 64;
  const bool is_printable =
      std::all_of(name.begin(), name.end(), [](unsigned char c) { return c >= 0x20 && c < 0x7f; });
  if (name.empty() || name.size() > max_length || !is_printable)
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
  // O_NONBLOCK, because opening a pipe would wait for a writer. Files that are not regular are refused below.
  const OpenFile file(path_, O_RDONLY | O_NONBLOCK, "read");
  struct stat status {};
  if (::fstat(file.descriptor(), &status) != 0) throw FileError("read", path_, errno);
  if (!S_ISREG(status.st_mode)) throw std::runtime_error("the key file " + path_.string() + " is no regular file");
  if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
    throw std::runtime_error("the key file " + path_.string() +
                             " may be written by others than its user: chmod 600 changes that");
  }
  std::string text;
  std::array<char, 4096> piece;
  while (const auto count = ::read(file.descriptor(), piece.data(), piece.size())) {
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw FileError("read", path_, errno);
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
  const OpenFile folder(folder_path, O_RDONLY | O_DIRECTORY, "open");
  while (::flock(folder.descriptor(), LOCK_EX) != 0)
    if (errno != EINTR) throw FileError("lock", folder_path, errno);
  auto keys = read();
  edit(keys);
  write_atomically(path_, {write_keys(keys)}, [&](int file) { give_to_owner_of(folder_path, file, path_); });
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
  key.max_stored = wanted.max_stored;
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
