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
  /// `action` is a verb, such as "write"; `number` is a value of errno.
  FileError(const std::string& action, const std::filesystem::path& path, int number);

  const std::string& action() const noexcept { return action_; }
  const std::filesystem::path& path() const noexcept { return path_; }
  int number() const noexcept { return number_; }
  /// The system's message for the number.
  std::string reason() const;

 private:
  std::string action_;
  std::filesystem::path path_;
  int number_;
};

/// A file or folder that is open until the end of the object's life.
class OpenFile {
 public:
  /// `flags` are those of open(2). Programs that are started do not inherit the file. Only its user may read and write
  /// a file that is created (mode 0600). Throws FileError "cannot `action` ...".
  OpenFile(const std::filesystem::path& path, int flags, const std::string& action);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/// The content of a file. Throws Error "file.unreadable" if there is no such file, or if it cannot be read, as a
/// folder.
std::string content_of(const std::filesystem::path& path);

/// Writes all bytes at the descriptor's position, even if signals interrupt. `path` is for the message. Throws
/// FileError.
void write_all(int descriptor, std::string_view bytes, const std::filesystem::path& path);

/// Returns once the content is on the disk. Throws FileError.
void synchronize(int descriptor, const std::filesystem::path& path);

/// Returns once the names in the folder of `path` are on the disk. Throws FileError.
void synchronize_folder_of(const std::filesystem::path& path);

/// The suffix of files that are being written.
inline constexpr std::string_view unfinished_suffix = ".part";

/// Writes `pieces`, one after the other, to a new file beside `path` (its name with an unused number and
/// `unfinished_suffix`), synchronizes it, renames it to `path` and synchronizes the folder. After a crash at any
/// moment, the file has either all of the new content or its old one. Only its user may read it (mode 0600). `prepare`,
/// if given, is called with the descriptor of the new file before the content is written.
///
/// Threads and processes may write the same file at the same time: it gets the content of the last one. Throws
/// FileError, and what `prepare` throws; then the new file is removed. A process that is killed leaves it behind.
void write_atomically(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces,
                      const std::function<void(int descriptor)>& prepare = {});

}  // namespace supple
