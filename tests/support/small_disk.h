#pragma once

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace supple::testing {
namespace detail {

/// Moves the process into a mount namespace of its own, so that no other process sees what it mounts. If it has no
/// right to do so, it gets the right in a user namespace of its own, which only a process with one thread can enter.
inline bool allow_mounts() {
  if (::unshare(CLONE_NEWNS) != 0) {
    const auto user = std::to_string(::geteuid());
    const auto group = std::to_string(::getegid());
    if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
    const auto write = [](const char* file, const std::string& text) {
      return static_cast<bool>(std::ofstream(file) << text << std::flush);
    };
    if (!write("/proc/self/setgroups", "deny") || !write("/proc/self/uid_map", "0 " + user + " 1") ||
        !write("/proc/self/gid_map", "0 " + group + " 1"))
      return false;
  }
  return ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
}

inline const bool may_mount = allow_mounts();  // at the start of the program, before there are other threads

}  // namespace detail

/// A disk of 1 MiB at a folder. Throws std::runtime_error where the process may neither mount one nor enter a user
/// namespace in which it may.
class SmallDisk {
 public:
  explicit SmallDisk(std::filesystem::path folder) : folder_(std::move(folder)) {
    if (!detail::may_mount || ::mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=1m") != 0)
      throw std::runtime_error("a disk of 1 MiB cannot be mounted: that takes the right to mount, or user namespaces");
  }
  ~SmallDisk() { EXPECT_EQ(::umount(folder_.c_str()), 0); }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  /// Takes all free space.
  void fill() const {
    std::ofstream ballast(this->ballast(), std::ios::binary | std::ios::app);
    const std::string page(4096, 'x');
    while (ballast.write(page.data(), static_cast<std::streamsize>(page.size())).flush()) {
    }
  }
  /// Gives back what fill() has taken.
  void make_space() const { std::filesystem::remove(ballast()); }

 private:
  std::filesystem::path ballast() const { return folder_ / "ballast"; }

  const std::filesystem::path folder_;
};

}  // namespace supple::testing
