#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <new>

#include "helper_channel.h"
#include "supple/base/byte_codec.h"
#include "supple/base/error.h"
#include "supple/base/helper_processes.h"

namespace supple {
namespace {

// Exit statuses, which are numbers that no library uses.
constexpr int answered = 86;  ///< a child has answered its request
constexpr int hung_up = 87;   ///< a child's channel was closed before a request came
constexpr int no_child = 71;  ///< this process cannot start a child

/// Makes this process end with the one that started it. The other end of the pipe closes however that process ends, and
/// the signal SIGIO, which reports this, ends this process whatever it is doing. PR_SET_PDEATHSIG would send its signal
/// already when the thread that started this process ends.
void end_with_parent() {
  std::signal(SIGIO, SIG_DFL);
  ::fcntl(helper_lifeline, F_SETOWN, ::getpid());
  ::fcntl(helper_lifeline, F_SETFL, O_NONBLOCK | O_ASYNC);
  pollfd entry{helper_lifeline, POLLIN, 0};
  if (::poll(&entry, 1, 0) != 0) ::_exit(0);  // that process has ended before
}

bool receive(char* into, std::size_t count) {
  while (count > 0) {
    const auto got = ::recv(helper_channel, into, count, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    into += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

bool send(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto sent = ::send(helper_channel, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

std::string failed(HelperOutcome outcome, std::string_view text) {
  return ByteWriter().number(outcome).text(text).take();
}

std::string answer(std::string_view request, const HelperTasks& tasks) {
  try {
    ByteReader reader(request);
    const std::string name = reader.text();
    const auto task = tasks.find(name);
    if (task == tasks.end()) return failed(HelperOutcome::exception, "there is no task of this name");
    return std::string(1, static_cast<char>(HelperOutcome::done)) +
           task->second(request.substr(sizeof(std::uint64_t) + name.size()));
  } catch (const Error& error) {
    ByteWriter writer;
    writer.number(HelperOutcome::error).text(error.code()).text(error.what());
    writer.list(error.details(), [&writer](const Error::Detail& detail) {
      writer.text(detail.where).text(detail.message).number(detail.shortage.has_value());
      if (detail.shortage) writer.number(detail.shortage->needed).number(detail.shortage->available);
    });
    return writer.take();
  } catch (const std::bad_alloc&) {
    return failed(HelperOutcome::out_of_memory, "");
  } catch (const std::exception& error) {
    return failed(HelperOutcome::exception, error.what());
  }
}

/// Limits the address space of this process to `memory` bytes (0: no limit).
void limit_address_space([[maybe_unused]] std::uint64_t memory) {
// The address space that a sanitizer reserves for itself is beyond any limit.
#ifndef SUPPLE_SANITIZED
  if (memory == 0) return;
  const rlimit limit{memory, memory};
  ::setrlimit(RLIMIT_AS, &limit);
#endif
}

/// The work of a child: it waits for a request, answers it and ends. It ends with its parent, too.
[[noreturn]] void serve_one(pid_t parent, const HelperTasks& tasks) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(0);  // the parent has ended before
  std::array<char, sizeof(std::uint64_t)> head{};
  if (!receive(head.data(), head.size())) ::_exit(hung_up);
  std::string request(ByteReader({head.data(), head.size()}).size(), '\0');
  if (!receive(request.data(), request.size())) ::_exit(hung_up);
  const std::string bytes = answer(request, tasks);
  if (send(ByteWriter().size(bytes.size()).take())) send(bytes);
  // _exit leaves out what libraries do at the end of a process, which takes time and has no use.
  ::_exit(answered);
}

int status_of(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

/// Ends this process in the way in which the child has ended, so that the process that started it learns of it.
[[noreturn]] void end_like(int status) {
  if (WIFSIGNALED(status)) {
    const rlimit no_core{0, 0};  // the child has written its own
    ::setrlimit(RLIMIT_CORE, &no_core);
    std::signal(WTERMSIG(status), SIG_DFL);
    std::raise(WTERMSIG(status));
  }
  ::_exit(WEXITSTATUS(status));
}

}  // namespace

void limit_cpu_time(std::chrono::seconds time) {
  rlimit limit{};
  ::getrlimit(RLIMIT_CPU, &limit);
  limit.rlim_cur = std::min(limit.rlim_max, static_cast<rlim_t>(time.count()));
  ::setrlimit(RLIMIT_CPU, &limit);
}

int serve_as_helper(int argc, char** argv, const HelperTasks& tasks) {
  if (argc != 2) return 2;
  end_with_parent();
  // These signals are left to the server, with which this process ends. Until then its computations may finish.
  std::signal(SIGTERM, SIG_IGN);
  std::signal(SIGINT, SIG_IGN);
  limit_address_space(std::strtoull(argv[1], nullptr, 10));
  // This process does not even read requests, because its allocations would change the addresses in its children's
  // memory. Each child is forked before its request comes, which therefore does not wait for the fork.
  const pid_t self = ::getpid();
  while (true) {
    const pid_t child = ::fork();
    if (child < 0) return no_child;
    if (child == 0) serve_one(self, tasks);
    const int status = status_of(child);
    if (!WIFEXITED(status)) end_like(status);
    if (WEXITSTATUS(status) == hung_up) return 0;
    if (WEXITSTATUS(status) != answered) end_like(status);
  }
}

}  // namespace supple
