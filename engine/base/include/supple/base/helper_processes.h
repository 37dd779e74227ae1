#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"

namespace supple {

struct HelperOptions {
  std::string program;       ///< the file of a program that calls `serve_as_helper`
  int processes = 0;         ///< at the same time; below 1: one for each core
  std::uint64_t memory = 0;  ///< bytes of address space of each; 0: no limit
};

/// Processes that run what cannot be stopped within this one: libraries that look for no stop request, such as mesh
/// generators and polygon clippers, and that could take the whole process with them.
///
/// A task is a name and bytes, its answer bytes. Processes are kept between tasks, so that a small one takes a tenth of
/// a millisecond longer than here; where there are none free another one is started, up to the limit, beyond which
/// callers wait. A process whose task is stopped is killed. All end with the process that started them, however that
/// ends. Members may be called from any thread.
class HelperProcesses {
 public:
  /// Starts the first one. Throws std::runtime_error where the program cannot be started.
  explicit HelperProcesses(HelperOptions options);
  /// Kills all. No task may run any more.
  ~HelperProcesses();
  HelperProcesses(const HelperProcesses&) = delete;
  HelperProcesses& operator=(const HelperProcesses&) = delete;

  /// Runs a task and returns its answer. Throws the Error that the task threw, with its code and details;
  /// "server.out_of_memory" at the limit of memory; "server.helper_ended" where the process ended by itself; and what
  /// the token throws, some milliseconds after a stop is requested: the process has gone then.
  std::string run(std::string_view task, std::string_view request, const Execution& execution);

  /// Of running and waiting processes.
  std::vector<int> process_ids() const;

 private:
  class Process;
  std::unique_ptr<Process> acquire(const Execution& execution);
  void release(std::unique_ptr<Process> process);

  const HelperOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<std::unique_ptr<Process>> idle_;
  std::map<const Process*, int> busy_;  ///< their numbers
  int starting_ = 0;
};

/// The helpers of this process; null, as at the start, where everything runs in this process itself.
std::shared_ptr<HelperProcesses> helper_processes();
void use_helper_processes(std::shared_ptr<HelperProcesses> helpers);

/// The file of this name in the folder of this process' program; empty where there is none.
std::string program_beside_this_one(const std::string& name);

/// What a helper can do: the answer's bytes of a request's.
using HelperTask = std::function<std::string(std::string_view request)>;
using HelperTasks = std::map<std::string, HelperTask, std::less<>>;

/// The main function of a helper: answers requests until the process that started it has gone.
int serve_as_helper(int argc, char** argv, const HelperTasks& tasks);

}  // namespace supple
