#pragma once

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace supple::testing {
namespace detail {

/// Gives the process the right to mount. A user who is not root gets it in a user namespace of its own, which only a
/// process with one thread can enter.
inline bool allow_mounts() {
  if (::geteuid() == 0) return true;
  const auto user = std::to_string(::geteuid());
  const auto group = std::to_string(::getegid());
  if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
  const auto write = [](const char* file, const std::string& text) {
    return static_cast<bool>(std::ofstream(file) << text << std::flush);
  };
  return write("/proc/self/setgroups", "deny") && write("/proc/self/uid_map", "0 " + user + " 1") &&
         write("/proc/self/gid_map", "0 " + group + " 1");
}

inline const bool may_mount = allow_mounts();  // at the start of the program, before there are other threads

}  // namespace detail

/// A disk of 1 MiB at a folder. Throws std::runtime_error where nobody may mount one: as root in a container without
/// that right, or as another user where user namespaces are switched off.
class SmallDisk {
 public:
  explicit SmallDisk(std::filesystem::path folder) : folder_(std::move(folder)) {
    if (!detail::may_mount || ::mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=1m") != 0)
      throw std::runtime_error("a disk of 1 MiB cannot be mounted: that takes root, or user namespaces");
  }
  ~SmallDisk() { EXPECT_EQ(::umount(folder_.c_str()), 0); }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  /// Takes all free space.
  void fill() const {
    std::ofstream ballast(this->ballast(), std::ios::binary | std::ios::app);
    while (ballast.put('x').flush()) {
    }
  }
  /// Gives back what fill() has taken.
  void make_space() const { std::filesystem::remove(ballast()); }

 private:
  std::filesystem::path ballast() const { return folder_ / "ballast"; }

  const std::filesystem::path folder_;
};

}  // namespace supple::testing
