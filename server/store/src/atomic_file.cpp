#include "atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>

#include "supple/base/error.h"

namespace supple::store {
namespace {

[[noreturn]] void fail(const std::string& action, const std::filesystem::path& path) {
  throw_file_error(action, path, errno);
}

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return value_; }

 private:
  int value_;
};

void synchronize_folder(const std::filesystem::path& folder) {
  const Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.get() < 0 || ::fsync(descriptor.get()) != 0) fail("synchronize", folder);
}

void write_durably(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces) {
  const Descriptor descriptor(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  if (descriptor.get() < 0) fail("create", path);
  for (auto bytes : pieces) {
    while (!bytes.empty()) {
      const auto count = ::write(descriptor.get(), bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail("write", path);
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }
  if (::fsync(descriptor.get()) != 0) fail("synchronize", path);
}

}  // namespace

bool means_full(int error) { return error == ENOSPC || error == EDQUOT || error == EFBIG; }

void throw_file_error(const std::string& action, const std::filesystem::path& path, int error) {
  throw Error(means_full(error) ? "store.full" : "store.unavailable", "The store cannot " + action + " " +
                                                                          path.filename().string() + ": " +
                                                                          std::generic_category().message(error) + ".");
}

void write_atomically(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces) {
  static std::atomic<unsigned> counter{0};
  std::filesystem::path part = path;
  part += "." + std::to_string(counter++) + std::string(unfinished_suffix);
  try {
    write_durably(part, pieces);
    if (::rename(part.c_str(), path.c_str()) != 0) fail("rename", part);
  } catch (...) {
    ::unlink(part.c_str());
    throw;
  }
  synchronize_folder(path.parent_path());
}

std::string read_file(const std::filesystem::path& path) {
  const Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor.get() < 0) {
    if (errno == ENOENT) throw Error("store.corrupted", "The stored file " + path.filename().string() + " is missing.");
    fail("open", path);
  }
  struct stat status {};
  if (::fstat(descriptor.get(), &status) != 0) fail("read", path);
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const auto count = ::read(descriptor.get(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("read", path);
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

std::int64_t bytes_of(const std::filesystem::path& path) noexcept {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? static_cast<std::int64_t>(status.st_size) : 0;
}

}  // namespace supple::store
