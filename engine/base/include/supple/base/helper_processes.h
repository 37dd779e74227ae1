#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/execution.h"

namespace supple {

struct HelperOptions {
  std::string program;       ///< the file of a program that calls `serve_as_helper`
  int processes = 0;         ///< processes at the same time; below 1 means one for each core
  std::uint64_t memory = 0;  ///< bytes of address space of each process; 0 means no limit
};

/// The process that ran a task ended before it answered ("server.helper_ended").
class HelperEnded : public Error {
 public:
  using Error::Error;
};

/// Processes that run what cannot be stopped within this process: libraries that do not check for stop requests, such
/// as mesh generators and polygon clippers, and whose crash would end the whole process.
///
/// A task consists of a name and bytes; its answer consists of bytes. The answer does not depend on earlier tasks: a
/// helper process runs no task itself, but forks a child for each. Without this, earlier tasks would change the
/// addresses in memory, by which some libraries order things. Processes are reused, so that a small task takes only one
/// or two milliseconds longer than in this process. If no process is free, another one is started, up to the limit.
/// Beyond the limit callers wait. Background threads have processes of their own, as many again, since a process has
/// the priority of the thread that started it. A process whose task is stopped is killed with its child. All of them
/// end with the process that started them, however that ends. Members may be called from any thread.
///
/// This process becomes the parent of orphans among its descendants (PR_SET_CHILD_SUBREAPER), so that it can wait for
/// the child of a helper that was killed.
class HelperProcesses {
 public:
  /// Starts the first process. Throws std::runtime_error if the program cannot be started.
  explicit HelperProcesses(HelperOptions options);
  /// Kills all processes. No task may run any more.
  ~HelperProcesses();
  HelperProcesses(const HelperProcesses&) = delete;
  HelperProcesses& operator=(const HelperProcesses&) = delete;

  /// Runs a task and returns its answer. Throws the Error that the task threw, with its code and details,
  /// "server.out_of_memory" at the limit of memory, and "server.helper_ended" if the process ended by itself. Some
  /// milliseconds after a stop is requested it throws what the token throws, and the process is gone.
  std::string run(std::string_view task, std::string_view request, const Execution& execution);

  /// The ids of busy and idle processes, each of which leads a process group of itself and its child.
  std::vector<int> process_ids() const;

 private:
  class Process;
  std::unique_ptr<Process> acquire(const Execution& execution);
  void release(std::unique_ptr<Process> process);
  // The caller of the following functions holds the mutex. No process is ended meanwhile, which takes milliseconds.
  /// Returns the process if there are enough idle ones, so that the caller ends it afterwards.
  [[nodiscard]] std::unique_ptr<Process> add_idle(std::unique_ptr<Process> process);
  /// Number of busy processes of threads in the background, or of the others.
  int busy(bool in_background) const;

  const HelperOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;  // for all who wait for a process, those in the background and the others
  std::vector<std::unique_ptr<Process>> idle_;
  std::map<const Process*, int> busy_;  ///< busy processes and their ids
  int starting_ = 0;
  int starting_in_background_ = 0;
};

/// The helpers of this process. Null, as at the start, means that everything runs in this process itself.
std::shared_ptr<HelperProcesses> helper_processes();
void use_helper_processes(std::shared_ptr<HelperProcesses> helpers);

/// The file of this name in the folder of this process's program; empty if there is none.
std::string program_beside_this_one(const std::string& name);

/// The tasks of a helper: each turns the bytes of a request into the bytes of an answer.
using HelperTask = std::function<std::string(std::string_view request)>;
using HelperTasks = std::map<std::string, HelperTask, std::less<>>;

/// The main function of a helper. It answers requests until the process that started it ends. Each request has a forked
/// child, which inherits the state of this process: preparations for all tasks may be made before the call. This
/// process must have one thread.
int serve_as_helper(int argc, char** argv, const HelperTasks& tasks);

/// For a task of a helper: its process ends when it has computed for this time (SIGXCPU), so that its caller gets
/// HelperEnded. This is CPU time, which does not pass faster on a busy machine.
void limit_cpu_time(std::chrono::seconds time);

}  // namespace supple
