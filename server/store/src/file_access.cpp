#include "file_access.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "record_file.h"
#include "supple/store/store_error.h"

namespace supple::store {

bool is_out_of_space(int error) { return error == ENOSPC || error == EDQUOT || error == EFBIG; }

void throw_file_error(const std::string& action, const std::filesystem::path& path, int error) {
  const auto message = "The store cannot " + action + " " + path.filename().string() + ": " +
                       std::generic_category().message(error) + ".";
  if (is_out_of_space(error)) throw StoreFull(message);
  throw StoreUnavailable(message);
}

void write_stored_file(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces) {
  try {
    write_atomically(path, pieces);
  } catch (const FileError& error) {
    throw_file_error(error.action(), error.path(), error.number());
  }
}

void write_unsynced_file(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces) {
  try {
    const OpenFile file(path, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW, "create");
    for (const auto piece : pieces) write_all(file.descriptor(), piece, path);
  } catch (const FileError& error) {
    ::unlink(path.c_str());
    throw_file_error(error.action(), error.path(), error.number());
  }
}

std::string read_file(const std::filesystem::path& path, const CancellationToken& cancellation) {
  try {
    const OpenFile file(path, O_RDONLY, "open");
    struct stat status {};
    if (::fstat(file.descriptor(), &status) != 0) throw FileError("read", path, errno);
    std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
    std::size_t done = 0;
    while (done < bytes.size()) {
      cancellation.throw_if_requested();
      constexpr std::size_t max_bytes_at_once = 4 << 20;
      const auto count =
          ::read(file.descriptor(), bytes.data() + done, std::min(bytes.size() - done, max_bytes_at_once));
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) throw FileError("read", path, errno);
      if (count == 0) break;
      done += static_cast<std::size_t>(count);
    }
    bytes.resize(done);
    return bytes;
  } catch (const FileError& error) {
    if (error.number() == ENOENT) throw_missing(path.filename().string());
    throw_file_error(error.action(), error.path(), error.number());
  }
}

std::int64_t bytes_of(const std::filesystem::path& path) noexcept {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? static_cast<std::int64_t>(status.st_size) : 0;
}

}  // namespace supple::store
