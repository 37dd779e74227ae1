#include "supple/trainings/lab_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "supple/base/error.h"

namespace supple::trainings {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int milliseconds_between_checks = 50;
constexpr std::size_t max_error_bytes = 4000;
constexpr std::size_t max_line_bytes = 4000;
constexpr int status_of_signals = 128;
/// Exit status of a child that could not become the program, as shells have it.
constexpr int status_not_started = 127;

/// A pipe whose ends close with it.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0)
      throw Error("training.unavailable", "A pipe cannot be made: " + std::system_category().message(errno) + ".");
  }
  ~Pipe() {
    close(0);
    close(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int out() const { return ends_[0]; }
  int in() const { return ends_[1]; }
  void close_in() { close(1); }

 private:
  void close(std::size_t end) {
    if (ends_[end] >= 0) ::close(std::exchange(ends_[end], -1));
  }
  std::array<int, 2> ends_{-1, -1};
};

/// Becomes the program, in a child process that shares nothing with threads any more. Only functions that may be called
/// between fork and exec are called.
[[noreturn]] void become(const LabCommand& command, char* const* arguments, int out, int errors, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(status_not_started);  // which has ended before
  if (command.memory > 0) {
    const rlimit limit{command.memory, command.memory};
    ::setrlimit(RLIMIT_AS, &limit);
  }
  const int null = ::open("/dev/null", O_RDONLY);
  ::dup2(null, STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(errors, STDERR_FILENO);
  ::close_range(STDERR_FILENO + 1, ~0U, 0);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execv(arguments[0], arguments);
  ::_exit(status_not_started);
}

class Child {
 public:
  explicit Child(const LabCommand& command) {
    if (::access(command.program.c_str(), X_OK) != 0)
      throw Error("training.unavailable", "The program " + command.program + " is not there.");
    std::vector<std::string> words{command.program};
    words.insert(words.end(), command.arguments.begin(), command.arguments.end());
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (auto& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const pid_t parent = ::getpid();
    id_ = ::fork();
    if (id_ < 0)
      throw Error("training.unavailable",
                  "The program " + command.program + " cannot be started: " + std::system_category().message(errno));
    if (id_ == 0) become(command, arguments.data(), out_.in(), errors_.in(), parent);
    out_.close_in();
    errors_.close_in();
  }
  ~Child() {
    if (id_ > 0) kill_and_reap();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  int out() const { return out_.out(); }
  int errors() const { return errors_.out(); }
  void request_end() const { ::kill(-id_, SIGTERM); }
  void kill_group() const { ::kill(-id_, SIGKILL); }

  /// Waits for the end of the process, after its pipes have closed.
  int reap() {
    int status = 0;
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    // What the program has started is in its group, and ends with it.
    kill_group();
    id_ = -1;
    return WIFSIGNALED(status) ? status_of_signals + WTERMSIG(status) : WEXITSTATUS(status);
  }

 private:
  void kill_and_reap() {
    kill_group();
    reap();
  }

  Pipe out_;
  Pipe errors_;
  pid_t id_ = -1;
};

/// Cuts what comes into lines. Only the beginning of a line that is too long is handed on.
class LineCutter {
 public:
  explicit LineCutter(const std::function<void(std::string_view)>& on_line) : on_line_(on_line) {}

  void add(std::string_view bytes) {
    for (const char c : bytes) {
      if (c == '\n') {
        on_line_(line_);
        line_.clear();
      } else if (line_.size() < max_line_bytes) {
        line_ += c;
      }
    }
  }

 private:
  const std::function<void(std::string_view)>& on_line_;
  std::string line_;
};

/// Reads what there is. False at the end.
template <class Take>
bool read_some(int descriptor, const Take& take) {
  std::array<char, 4096> buffer;
  const auto count = ::read(descriptor, buffer.data(), buffer.size());
  if (count > 0) take(std::string_view(buffer.data(), static_cast<std::size_t>(count)));
  return count > 0 || (count < 0 && errno == EINTR);
}

}  // namespace

LabEnding run_lab(const LabCommand& command, const CancellationToken& cancellation,
                  const std::function<void(std::string_view)>& on_line) {
  Child child(command);
  LabEnding ending;
  LineCutter lines(on_line);
  Clock::time_point kill_at;
  std::array<pollfd, 2> pipes{{{child.out(), POLLIN, 0}, {child.errors(), POLLIN, 0}}};
  while (pipes[0].fd >= 0 || pipes[1].fd >= 0) {
    ::poll(pipes.data(), pipes.size(), milliseconds_between_checks);
    if (pipes[0].revents != 0 && !read_some(pipes[0].fd, [&](std::string_view bytes) { lines.add(bytes); }))
      pipes[0].fd = -1;
    if (pipes[1].revents != 0 && !read_some(pipes[1].fd, [&](std::string_view bytes) {
          ending.errors += bytes;
          if (ending.errors.size() > max_error_bytes) ending.errors.erase(0, ending.errors.size() - max_error_bytes);
        }))
      pipes[1].fd = -1;
    for (auto& pipe : pipes) pipe.revents = 0;
    if (!cancellation.requested()) continue;
    if (!ending.stopped) {
      ending.stopped = true;
      kill_at = Clock::now() + command.grace;
      child.request_end();
    } else if (Clock::now() > kill_at) {
      child.kill_group();
    }
  }
  ending.status = child.reap();
  if (ending.status == status_not_started && !ending.stopped)
    throw Error("training.unavailable", "The program " + command.program + " cannot be started. " + ending.errors);
  return ending;
}

}  // namespace supple::trainings
