#include "supple/base/durable_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <optional>
#include <system_error>

#include "supple/base/error.h"

namespace supple {
namespace {

constexpr mode_t user_only_mode = 0600;

std::string reason_of(int number) { return std::generic_category().message(number); }

}  // namespace

FileError::FileError(const std::string& action, const std::filesystem::path& path, int number)
    : std::runtime_error("cannot " + action + " " + path.string() + ": " + reason_of(number)),
      action_(action),
      path_(path),
      number_(number) {}

std::string FileError::reason() const { return reason_of(number_); }

OpenFile::OpenFile(const std::filesystem::path& path, int flags, const std::string& action)
    : descriptor_(::open(path.c_str(), flags | O_CLOEXEC, user_only_mode)) {
  if (descriptor_ < 0) throw FileError(action, path, errno);
}

OpenFile::~OpenFile() { ::close(descriptor_); }

std::string content_of(const std::filesystem::path& path) {
  try {
    const OpenFile file(path, O_RDONLY, "open");
    std::string content;
    std::array<char, 1 << 16> piece{};
    while (const auto count = ::read(file.descriptor(), piece.data(), piece.size())) {
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) throw FileError("read", path, errno);
      content.append(piece.data(), static_cast<std::size_t>(count));
    }
    return content;
  } catch (const FileError& error) {
    throw Error("file.unreadable", path.string() + ": " + error.reason() + ".");
  }
}

void write_all(int descriptor, std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const auto count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw FileError("write", path, errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void synchronize(int descriptor, const std::filesystem::path& path) {
  if (::fsync(descriptor) != 0) throw FileError("synchronize", path, errno);
}

void synchronize_folder_of(const std::filesystem::path& path) {
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const OpenFile open(folder, O_RDONLY | O_DIRECTORY, "open");
  synchronize(open.descriptor(), folder);
}

void write_atomically(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces,
                      const std::function<void(int descriptor)>& prepare) {
  static std::atomic<unsigned> counter{0};
  std::filesystem::path part;
  std::optional<OpenFile> file;
  while (!file) {
    part = path;
    part += "." + std::to_string(counter++) + std::string(unfinished_suffix);
    try {
      file.emplace(part, O_WRONLY | O_CREAT | O_EXCL, "create");
    } catch (const FileError& error) {
      if (error.number() != EEXIST) throw;  // another process uses this number, or has left the file behind
    }
  }
  try {
    if (prepare) prepare(file->descriptor());
    for (const auto piece : pieces) write_all(file->descriptor(), piece, part);
    synchronize(file->descriptor(), part);
    if (::rename(part.c_str(), path.c_str()) != 0) throw FileError("rename", part, errno);
  } catch (...) {
    ::unlink(part.c_str());
    throw;
  }
  synchronize_folder_of(path);
}

}  // namespace supple
