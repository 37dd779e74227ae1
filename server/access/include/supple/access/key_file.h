#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "supple/access/key.h"

namespace supple::access {

/// The file of keys. It holds no secret, only salted hashes; still it is for the server's user alone (mode 0600).
///
/// Text for people to look at: a line "key ID" and indented lines "field value" for each, see `write_keys`.
class KeyFile {
 public:
  explicit KeyFile(std::filesystem::path path) : path_(std::move(path)) {}

  const std::filesystem::path& path() const { return path_; }
  bool exists() const;
  /// Empty where there is no file. Throws std::runtime_error, which names the file, where it cannot be read, where a
  /// line is not understood, and where others than its user may write it.
  std::vector<Key> read() const;
  /// Reads the keys, has them changed, and puts a complete new file in the place of the old one, durably. Of several
  /// processes that do so each waits for the other. Makes the folder (mode 0700) where it does not exist. Root leaves
  /// the file to the user of the folder, whose server reads it. Throws std::runtime_error.
  void change(const std::function<void(std::vector<Key>&)>& edit) const;

 private:
  std::filesystem::path path_;
};

/// The text of the file.
std::string write_keys(const std::vector<Key>& keys);
/// Throws std::runtime_error "line 7: ...".
std::vector<Key> parse_keys(const std::string& text);

/// What a new key is to be. `expires_in` in seconds; 0: never.
struct NewKey {
  std::string name;
  Scopes scopes;
  std::int64_t expires_in = 0;
  int requests_per_minute = 0;
  int max_waiting_jobs = 0;
  std::int64_t max_stored = 0;
};

/// Adds a key; returns what its holder sends, which is told nowhere else. Throws std::runtime_error for a name that is
/// empty, longer than 64 characters, has others than printable ones of ASCII, or is taken. `now` in seconds since 1970.
Token add_key(std::vector<Key>& keys, const NewKey& wanted, std::int64_t now);
/// Gives a key a new secret; the old one is accepted for `overlap` seconds more. One that is still accepted from the
/// rotation before is not any longer. Throws std::runtime_error for an unknown or expired key.
Token rotate_key(std::vector<Key>& keys, const std::string& id, std::int64_t overlap, std::int64_t now);
/// Throws std::runtime_error for an unknown key.
void revoke_key(std::vector<Key>& keys, const std::string& id);

}  // namespace supple::access
