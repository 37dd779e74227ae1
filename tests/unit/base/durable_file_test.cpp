#include "supple/base/durable_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace {

/// The system calls on files while a test listened, and which synchronization is to fail.
struct Calls {
  std::vector<std::string> events;
  int fail_at_synchronization = 0;
  int synchronizations = 0;
};
Calls* listening = nullptr;

std::string name_of(int descriptor) {
  std::array<char, 4096> path{};
  const auto link = "/proc/self/fd/" + std::to_string(descriptor);
  const auto length = ::readlink(link.c_str(), path.data(), path.size() - 1);
  return length < 0 ? std::string() : std::string(path.data(), static_cast<std::size_t>(length));
}

}  // namespace

// These definitions replace those of the C library: on a healthy disk no synchronization fails, and none can be
// observed.
extern "C" int fsync(int descriptor) {
  if (listening) {
    listening->events.push_back("synchronize " + name_of(descriptor));
    if (++listening->synchronizations == listening->fail_at_synchronization) {
      errno = EIO;
      return -1;
    }
  }
  return static_cast<int>(::syscall(SYS_fsync, descriptor));
}

extern "C" int rename(const char* from, const char* to) noexcept {
  if (listening) listening->events.push_back("rename to " + std::string(to));
  return static_cast<int>(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

namespace supple {
namespace {

namespace fs = std::filesystem;

class DurableFile : public ::testing::Test {
 protected:
  DurableFile() {
    std::string pattern = (fs::temp_directory_path() / "supple_durable_XXXXXX").string();
    folder_ = fs::canonical(mkdtemp(pattern.data()));
    path_ = folder_ / "file";
  }
  ~DurableFile() override {
    listening = nullptr;
    fs::remove_all(folder_);
  }

  std::string content() const {
    std::ostringstream text;
    text << std::ifstream(path_, std::ios::binary).rdbuf();
    return text.str();
  }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
  fs::path path_;
};

TEST_F(DurableFile, HasAllPiecesInTheirOrderAndIsItsUsersAlone) {
  write_atomically(path_, {"first", std::string_view("\0\n", 2), "", "last"});
  EXPECT_EQ(content(), std::string("first\0\nlast", 11));
  EXPECT_EQ(fs::status(path_).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  write_atomically(path_, {"new"});
  EXPECT_EQ(content(), "new");
  EXPECT_EQ(files(), 1U);
}

TEST_F(DurableFile, IsOnTheDiskBeforeItsNameAndItsNameBeforeTheCallReturns) {
  Calls calls;
  listening = &calls;
  write_atomically(path_, {"content"});
  listening = nullptr;
  ASSERT_EQ(calls.events.size(), 3U);
  EXPECT_TRUE(calls.events[0].starts_with("synchronize " + path_.string() + ".")) << calls.events[0];
  EXPECT_TRUE(calls.events[0].ends_with(unfinished_suffix)) << calls.events[0];
  EXPECT_EQ(calls.events[1], "rename to " + path_.string());
  EXPECT_EQ(calls.events[2], "synchronize " + folder_.string());
}

TEST_F(DurableFile, IsAsItWasWhereTheDiskRefusesItsContent) {
  write_atomically(path_, {"old"});
  Calls calls;
  calls.fail_at_synchronization = 1;
  listening = &calls;
  try {
    write_atomically(path_, {"new"});
    ADD_FAILURE() << "nothing was thrown";
  } catch (const FileError& error) {
    EXPECT_EQ(error.number(), EIO);
    EXPECT_EQ(error.action(), "synchronize");
    EXPECT_EQ(std::string(error.what()), "cannot synchronize " + error.path().string() + ": " + error.reason());
  }
  listening = nullptr;
  EXPECT_EQ(content(), "old");
  EXPECT_EQ(files(), 1U) << "nothing half-written is left";
}

TEST_F(DurableFile, SaysThatItsNameMayNotOutliveAPowerFailure) {
  Calls calls;
  calls.fail_at_synchronization = 2;
  listening = &calls;
  EXPECT_THROW(write_atomically(path_, {"new"}), FileError);
}

TEST_F(DurableFile, IsAsItWasWhereThereIsNoSpace) {
  write_atomically(path_, {"old"});
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    int number = 0;
    try {
      write_atomically(path_, {std::string(5000, 'x')});
    } catch (const FileError& error) {
      number = error.number();
    }
    ::_exit(number == EFBIG ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(content(), "old");
  EXPECT_EQ(files(), 1U);
}

TEST_F(DurableFile, IsPreparedBeforeItHasContentAndNotLeftWherePreparingFails) {
  std::string seen;
  write_atomically(path_, {"content"}, [&](int descriptor) {
    struct stat status {};
    ::fstat(descriptor, &status);
    seen = std::to_string(status.st_size) + " bytes, mode " + std::to_string(status.st_mode & 0777);
  });
  EXPECT_EQ(seen, "0 bytes, mode " + std::to_string(0600));
  EXPECT_THROW(write_atomically(path_, {"new"}, [](int) { throw std::runtime_error("no"); }), std::runtime_error);
  EXPECT_EQ(content(), "content");
  EXPECT_EQ(files(), 1U);
}

TEST_F(DurableFile, FollowsNoLinkThatSomebodyPutInItsWay) {
  const auto victim = folder_ / "victim";
  std::ofstream(victim) << "mine";
  // The links have all names that the next unfinished file may get.
  for (int i = 0; i < 100; ++i) fs::create_symlink(victim, path_.string() + "." + std::to_string(i) + ".part");
  write_atomically(path_, {"new"});
  EXPECT_EQ(content(), "new");
  EXPECT_FALSE(fs::is_symlink(path_));
  path_ = victim;
  EXPECT_EQ(content(), "mine");
}

TEST_F(DurableFile, IsWholeWhereAnotherProcessWritesItAtTheSameTime) {
  std::array<int, 2> begun{};
  std::array<int, 2> ended{};
  ASSERT_EQ(::pipe(begun.data()) + ::pipe(ended.data()), 0);
  char signal = 0;
  const pid_t other = fork();  // its unfinished files begin with the same number
  if (other == 0) {
    try {
      write_atomically(path_, {"of the ", "other"}, [&](int) {
        if (::write(begun[1], "x", 1) != 1 || ::read(ended[0], &signal, 1) != 1) throw std::runtime_error("no signal");
      });
    } catch (const std::exception&) {
      ::_exit(1);
    }
    ::_exit(0);
  }
  ASSERT_EQ(::read(begun[0], &signal, 1), 1);
  write_atomically(path_, {"of this process"});
  EXPECT_EQ(content(), "of this process");
  ASSERT_EQ(::write(ended[1], "x", 1), 1);
  int status = -1;
  ASSERT_EQ(waitpid(other, &status, 0), other);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(content(), "of the other");
  EXPECT_EQ(files(), 1U);
  for (const int descriptor : {begun[0], begun[1], ended[0], ended[1]}) ::close(descriptor);
}

TEST_F(DurableFile, MayBeNamedWithoutItsFolder) {
  const auto before = fs::current_path();
  fs::current_path(folder_);
  write_atomically("file", {"here"});
  fs::current_path(before);
  EXPECT_EQ(content(), "here");
}

TEST_F(DurableFile, SaysWhatCannotBeOpened) {
  try {
    const OpenFile file(folder_ / "missing", O_RDONLY, "read");
    ADD_FAILURE() << "nothing was thrown";
  } catch (const FileError& error) {
    EXPECT_EQ(error.number(), ENOENT);
    EXPECT_EQ(error.what(), "cannot read " + (folder_ / "missing").string() + ": No such file or directory");
  }
}

}  // namespace
}  // namespace supple
