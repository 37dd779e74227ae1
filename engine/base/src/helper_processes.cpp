#include "supple/base/helper_processes.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "helper_channel.h"
#include "supple/base/background_threads.h"
#include "supple/base/byte_codec.h"
#include "supple/base/error.h"

extern char** environ;

namespace supple {
namespace {

/// The interval at which waiting threads check the token, since a stop request does not wake them.
constexpr int milliseconds_between_checks = 10;
/// Limits of idle processes. Others are ended, since each occupies the memory of its libraries.
constexpr int max_idle_processes = 2;
constexpr int max_idle_background_processes = 1;
constexpr std::size_t max_bytes_per_send = 1 << 16;

/// A file descriptor that the destructor closes.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  void reset(int number) {
    close();
    number_ = number;
  }
  void close() {
    if (number_ >= 0) ::close(std::exchange(number_, -1));
  }
  int get() const { return number_; }

 private:
  int number_;
};

std::string ending_of(int status) {
  if (WIFSIGNALED(status))
    return std::string("signal ") + std::to_string(WTERMSIG(status)) + " (" + ::strsignal(WTERMSIG(status)) + ")";
  return "status " + std::to_string(WEXITSTATUS(status));
}

/// The descriptors, the signal mask and the process group with which a helper begins.
class SpawnSettings {
 public:
  SpawnSettings(int channel, int lifeline) {
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawnattr_init(&attributes_);
    // Both are first duplicated to higher numbers, for one of the two may have the other's final number.
    constexpr int free_number = 64;
    ::posix_spawn_file_actions_adddup2(&actions_, channel, free_number);
    ::posix_spawn_file_actions_adddup2(&actions_, lifeline, free_number + 1);
    ::posix_spawn_file_actions_adddup2(&actions_, free_number, helper_channel);
    ::posix_spawn_file_actions_adddup2(&actions_, free_number + 1, helper_lifeline);
    // The helper inherits no other descriptor: connections of the server that it kept open would not close.
    ::posix_spawn_file_actions_addclosefrom_np(&actions_, helper_lifeline + 1);
    ::posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    // A helper and its child are a process group of their own, so that a terminal's signals end the server, but not its
    // computations.
    sigset_t none;
    ::sigemptyset(&none);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    ::posix_spawnattr_setpgroup(&attributes_, 0);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnSettings() {
    ::posix_spawn_file_actions_destroy(&actions_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  const posix_spawn_file_actions_t* actions() const { return &actions_; }
  const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

}  // namespace

/// One helper process, which the destructor kills.
class HelperProcesses::Process {
 public:
  explicit Process(const HelperOptions& options) {
    std::array<int, 2> sockets{};
    std::array<int, 2> pipe{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0) fail("socketpair");
    channel_.reset(sockets[0]);
    const Descriptor child_channel(sockets[1]);
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) fail("pipe");
    lifeline_.reset(pipe[1]);
    const Descriptor child_lifeline(pipe[0]);
    const SpawnSettings settings(child_channel.get(), child_lifeline.get());
    std::string program = options.program;
    std::string memory = std::to_string(options.memory);
    std::array<char*, 3> arguments{program.data(), memory.data(), nullptr};
    const int error =
        ::posix_spawn(&id_, program.c_str(), settings.actions(), settings.attributes(), arguments.data(), environ);
    if (error != 0) throw std::runtime_error("cannot start " + program + ": " + std::system_category().message(error));
  }
  ~Process() { end(); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  int id() const { return static_cast<int>(id_); }
  /// Whether a background thread has started it, whose priority it has.
  bool is_in_background() const { return is_in_background_; }
  /// Whether the process still runs, without a task.
  bool alive() {
    pollfd entry{channel_.get(), POLLIN, 0};
    return ::poll(&entry, 1, 0) == 0;
  }

  /// Kills the process and its child if they still run, and says how the process ended.
  std::string end() {
    if (id_ <= 0) return {};
    int status = 0;
    ::kill(-id_, SIGKILL);
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    return reap(status);
  }
  /// How the process ended by itself, after its channel closed. Kills it if it does not end within 2 seconds.
  std::string ending() {
    int status = 0;
    for (int check = 0; check < 200; ++check) {
      const auto ended = ::waitpid(id_, &status, WNOHANG);
      if (ended == id_) return reap(status);
      std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds_between_checks));
    }
    return end();
  }

  /// Sends all bytes. False if the channel closes before.
  bool send(std::string_view bytes, const CancellationToken& token) {
    while (!bytes.empty()) {
      const auto sent =
          ::send(channel_.get(), bytes.data(), std::min(bytes.size(), max_bytes_per_send), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent > 0) {
        bytes.remove_prefix(static_cast<std::size_t>(sent));
      } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
        wait(POLLOUT, token);
      } else if (errno != EINTR) {
        return false;
      }
    }
    return true;
  }

  /// Receives `count` bytes. False if the channel closes before.
  bool receive(char* into, std::size_t count, const CancellationToken& token) {
    while (count > 0) {
      const auto got = ::recv(channel_.get(), into, count, MSG_DONTWAIT);
      if (got > 0) {
        into += got;
        count -= static_cast<std::size_t>(got);
      } else if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
        wait(POLLIN, token);
      } else if (got == 0 || errno != EINTR) {
        return false;
      }
    }
    return true;
  }

 private:
  [[noreturn]] static void fail(const char* what) {
    throw std::system_error(errno, std::system_category(), std::string("a helper process: ") + what);
  }
  /// Waits for the child of the process, which was killed with it and has become a child of this process.
  std::string reap(int status) {
    while (::waitpid(-id_, nullptr, 0) > 0 || errno == EINTR) {
    }
    id_ = 0;
    return ending_of(status);
  }
  void wait(short events, const CancellationToken& token) const {
    token.throw_if_requested();
    pollfd entry{channel_.get(), events, 0};
    ::poll(&entry, 1, milliseconds_between_checks);
    token.throw_if_requested();
  }

  const bool is_in_background_ = is_background_thread();
  Descriptor channel_;
  Descriptor lifeline_;
  pid_t id_ = 0;
};

HelperProcesses::HelperProcesses(HelperOptions options)
    : options_([&options] {
        if (options.processes < 1)
          options.processes = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
        return std::move(options);
      }()) {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  idle_.push_back(std::make_unique<Process>(options_));
}

HelperProcesses::~HelperProcesses() = default;

std::unique_ptr<HelperProcesses::Process> HelperProcesses::acquire(const Execution& execution) {
  const bool in_background = is_background_thread();
  int& starting = in_background ? starting_in_background_ : starting_;
  const auto is_fitting = [&](const auto& process) { return process->is_in_background() == in_background; };
  std::vector<std::unique_ptr<Process>> ended;  // destroyed after the mutex is unlocked
  std::unique_lock lock(mutex_);
  while (true) {
    execution.cancellation.throw_if_requested();
    for (auto found = idle_.end(); (found = std::find_if(idle_.begin(), idle_.end(), is_fitting)) != idle_.end();) {
      auto process = std::move(*found);
      idle_.erase(found);
      if (!process->alive()) {
        ended.push_back(std::move(process));
        continue;
      }
      busy_.emplace(process.get(), process->id());
      return process;
    }
    if (busy(in_background) + starting < options_.processes) break;
    wake_.wait_for(lock, std::chrono::milliseconds(milliseconds_between_checks));
  }
  ++starting;
  lock.unlock();
  std::unique_ptr<Process> process;
  try {
    process = std::make_unique<Process>(options_);
  } catch (...) {
    lock.lock();
    --starting;
    wake_.notify_all();
    throw;
  }
  lock.lock();
  --starting;
  busy_.emplace(process.get(), process->id());
  return process;
}

void HelperProcesses::release(std::unique_ptr<Process> process) {
  std::unique_ptr<Process> surplus;  // destroyed after the mutex is unlocked
  const std::lock_guard lock(mutex_);
  busy_.erase(process.get());
  surplus = add_idle(std::move(process));
  wake_.notify_all();
}

std::unique_ptr<HelperProcesses::Process> HelperProcesses::add_idle(std::unique_ptr<Process> process) {
  const bool in_background = process->is_in_background();
  const auto idle = std::count_if(idle_.begin(), idle_.end(),
                                  [&](const auto& one) { return one->is_in_background() == in_background; });
  if (idle >= (in_background ? max_idle_background_processes : max_idle_processes)) return process;
  idle_.push_back(std::move(process));
  return nullptr;
}

int HelperProcesses::busy(bool in_background) const {
  return static_cast<int>(std::count_if(
      busy_.begin(), busy_.end(), [&](const auto& entry) { return entry.first->is_in_background() == in_background; }));
}

std::string HelperProcesses::run(std::string_view task, std::string_view request, const Execution& execution) {
  auto process = acquire(execution);
  /// Kills a process that was not given back, and starts another one at once, since that takes a while.
  struct Replacement {
    HelperProcesses& helpers;
    std::unique_ptr<Process>& process;
    ~Replacement() {
      if (!process) return;
      const Process* const old = process.get();
      process->end();
      std::unique_ptr<Process> next;
      try {
        next = std::make_unique<Process>(helpers.options_);
      } catch (const std::exception&) {
        // The next task tries again, and says why it cannot be started.
      }
      std::unique_ptr<Process> surplus;  // destroyed after the mutex is unlocked
      const std::lock_guard lock(helpers.mutex_);
      helpers.busy_.erase(old);
      if (next) surplus = helpers.add_idle(std::move(next));
      helpers.wake_.notify_all();
    }
  } const replacement{*this, process};
  const auto ended = [&] {
    const std::string ending = process->ending();
    return HelperEnded("server.helper_ended", "The helper process that ran the task " + std::string(task) +
                                                  " ended with " + ending + "; its memory is limited to " +
                                                  std::to_string(options_.memory) + " bytes (0: not at all).");
  };

  const std::string head = ByteWriter().size(task.size() + request.size() + sizeof(std::uint64_t)).text(task).take();
  const CancellationToken& token = execution.cancellation;
  if (!process->send(head, token) || !process->send(request, token)) throw ended();
  std::array<char, sizeof(std::uint64_t)> length{};
  if (!process->receive(length.data(), length.size(), token)) throw ended();
  std::string answer(ByteReader({length.data(), length.size()}).size(), '\0');
  if (answer.empty() || !process->receive(answer.data(), answer.size(), token)) throw ended();
  release(std::move(process));

  const auto outcome = static_cast<HelperOutcome>(answer.front());
  if (outcome == HelperOutcome::done) {
    answer.erase(0, 1);
    return answer;
  }
  ByteReader reader(std::string_view(answer).substr(1));
  if (outcome == HelperOutcome::out_of_memory)
    throw Error("server.out_of_memory", "The task " + std::string(task) + " needs more than the " +
                                            std::to_string(options_.memory) +
                                            " bytes of memory that its helper process has.");
  if (outcome != HelperOutcome::error)
    throw std::runtime_error("the task " + std::string(task) + " of a helper process: " + reader.text());
  const std::string code = reader.text();
  const std::string message = reader.text();
  std::vector<Error::Detail> details;
  reader.list(details, [&reader] {
    Error::Detail detail;
    detail.where = reader.text();
    detail.message = reader.text();
    // The numbers are read in this order, since those in braces are evaluated one after the other.
    if (reader.number<bool>()) detail.shortage = Error::Shortage{reader.number<double>(), reader.number<double>()};
    return detail;
  });
  throw Error(code, message, std::move(details));
}

std::vector<int> HelperProcesses::process_ids() const {
  const std::lock_guard lock(mutex_);
  std::vector<int> ids;
  for (const auto& process : idle_) ids.push_back(process->id());
  for (const auto& [process, id] : busy_) ids.push_back(id);
  return ids;
}

namespace {

std::mutex current_mutex;
std::shared_ptr<HelperProcesses> current;

}  // namespace

std::shared_ptr<HelperProcesses> helper_processes() {
  const std::lock_guard lock(current_mutex);
  return current;
}

void use_helper_processes(std::shared_ptr<HelperProcesses> helpers) {
  const std::lock_guard lock(current_mutex);
  current.swap(helpers);
}

std::string program_beside_this_one(const std::string& name) {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return {};
  const auto file = program.parent_path() / name;
  return std::filesystem::is_regular_file(file, error) ? file.string() : std::string();
}

}  // namespace supple
