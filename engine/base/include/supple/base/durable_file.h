#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>

namespace supple {

/// A system call on a file failed. what() is "cannot write /data/x: No space left on device".
class FileError : public std::runtime_error {
 public:
  /// `action` is a verb, "write"; `number` is of errno.
  FileError(const std::string& action, const std::filesystem::path& path, int number);

  const std::string& action() const noexcept { return action_; }
  const std::filesystem::path& path() const noexcept { return path_; }
  int number() const noexcept { return number_; }
  /// The system's words for the number.
  std::string reason() const;

 private:
  std::string action_;
  std::filesystem::path path_;
  int number_;
};

/// A file or folder that is open until the end of the object's life.
class OpenFile {
 public:
  /// `flags` are those of open(2); no program that is started inherits it. A file that is made is for its user alone
  /// (mode 0600). Throws FileError "cannot `action` ...".
  OpenFile(const std::filesystem::path& path, int flags, const std::string& action);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/// All bytes at the descriptor's place, whatever interrupts. `path` is for the message. Throws FileError.
void write_all(int descriptor, std::string_view bytes, const std::filesystem::path& path);

/// Returns once the content is on the disk. Throws FileError.
void synchronize(int descriptor, const std::filesystem::path& path);

/// Returns once the names in the folder of `path` are on the disk. Throws FileError.
void synchronize_folder_of(const std::filesystem::path& path);

/// The suffix of files that are being written.
inline constexpr std::string_view unfinished_suffix = ".part";

/// Writes `pieces`, one after the other, to a new neighbour of `path` (its name with a number that none has yet and
/// `unfinished_suffix`), synchronizes it, renames it into place and synchronizes the folder: afterwards, or after a
/// crash at any moment, the file has all of the new content, or it is as it was before. Only its user may read it (mode
/// 0600). `prepare`, where it is given, gets the descriptor of the new file before its content.
///
/// Threads and processes may write the same file at the same time: it has the content of the one that was last. Throws
/// FileError, and what `prepare` throws; then nothing of it is left. A process that is killed leaves the neighbour.
void write_atomically(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces,
                      const std::function<void(int descriptor)>& prepare = {});

}  // namespace supple
