#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "supple/access/key.h"

namespace supple::access {

/// The file of keys. It contains salted hashes and no secrets, but only the server's user may read it (mode 0600).
///
/// For each key it has a line "key ID" and indented lines "field value", see `write_keys`.
class KeyFile {
 public:
  explicit KeyFile(std::filesystem::path path) : path_(std::move(path)) {}

  const std::filesystem::path& path() const { return path_; }
  bool exists() const;
  /// Reads all keys; there are none if the file does not exist. Throws std::runtime_error, which names the file, if it
  /// cannot be read, if a line is not understood, or if its mode allows others to write it.
  std::vector<Key> read() const;
  /// Reads the keys, calls `edit`, and atomically and durably replaces the file. A lock makes concurrent processes wait
  /// for each other. A missing folder is made (mode 0700). If root calls this, the file gets the owner of the folder,
  /// because the server of that user reads it. Throws std::runtime_error.
  void change(const std::function<void(std::vector<Key>&)>& edit) const;

 private:
  std::filesystem::path path_;
};

/// The text of a key file.
std::string write_keys(const std::vector<Key>& keys);
/// Parses the text of a key file. Throws std::runtime_error "line 7: ...".
std::vector<Key> parse_keys(const std::string& text);

/// Properties of a new key; the limits are those of Key.
struct NewKey {
  std::string name;
  Scopes scopes;
  std::int64_t expires_in = 0;  ///< seconds; 0: it never expires
  int requests_per_minute = 0;
  int max_waiting_jobs = 0;
  std::int64_t max_stored = 0;
};

/// Adds a key at the time `now` (seconds since 1970). Returns its token, which contains the secret and cannot be
/// obtained again. Throws std::runtime_error if the name is used by another key, or is not 1 to 64 printable ASCII
/// characters.
Token add_key(std::vector<Key>& keys, const NewKey& wanted, std::int64_t now);
/// Gives a key a new secret and returns its new token. The old secret is accepted for `overlap` more seconds; a still
/// older one is rejected from now on. Throws std::runtime_error for an unknown or expired key.
Token rotate_key(std::vector<Key>& keys, const std::string& id, std::int64_t overlap, std::int64_t now);
/// Removes a key. Throws std::runtime_error for an unknown key.
void revoke_key(std::vector<Key>& keys, const std::string& id);

}  // namespace supple::access
