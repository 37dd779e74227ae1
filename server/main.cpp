// supple-server: opens the store, starts the workers and answers HTTP until SIGTERM or SIGINT.

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <thread>

#include "commands.h"
#include "server_log.h"
#include "server_options.h"
#include "store_recovery.h"
#include "supple/base/helper_processes.h"
#include "supple/base/threads.h"
#include "supple/budget/counting_malloc.h"
#include "supple/budget/memory.h"
#include "supple/json/answers.h"
#include "supple/json/json_writer.h"
#include "supple/json/model_answers.h"
#include "supple/routes/audit.h"
#include "supple/routes/guard.h"
#include "supple/routes/resume.h"
#include "supple/routes/routes.h"
#include "supple/store/local_store.h"
#include "supple/store/shared_store.h"
#include "version.h"

namespace supple {
namespace {

/// Blocks SIGTERM and SIGINT in this thread and in all threads that it starts, so that the main thread can wait for
/// them.
sigset_t block_end_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

std::string host_in_url(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

store::ModelStore::Options model_options(const ServerOptions& server) {
  store::ModelStore::Options options;
  options.folder = server.models;
  options.own_folder = server.data + "/models";
  options.max_file_bytes = server.max_model;
  options.describe = json::write_model;
  options.log = [](store::ModelStore::Level level, const std::string& text) {
    level == store::ModelStore::Level::warning ? spdlog::warn(text) : spdlog::info(text);
  };
  return options;
}

void log_access(const http::AnsweredRequest& answered) {
  using routes::plain_text;
  spdlog::info("access {} {} {} {} {} {} {:.6f} s {} bytes", plain_text(answered.id), answered.address,
               plain_text(answered.key), plain_text(answered.method), plain_text(answered.path), answered.status,
               answered.seconds, answered.body_bytes);
}

/// Ends the process after `seconds`, even if computations still run. Everything that the store has acknowledged is on
/// disk.
void exit_after(double seconds) {
  std::thread([seconds] {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    spdlog::warn("a computation does not stop: ending without it");
    std::_Exit(0);
  }).detach();
}

/// The parts of the process. A part may use those that are declared before it.
class Process {
 public:
  Process(const ServerOptions& options, sigset_t signals)
      : options_(options),
        signals_(signals),
        memory_(options.memory, options.request_memory, options.process_memory),
        gate_(options.key_file(), options.rule_of_keys(), [](const std::string& text) { spdlog::warn(text); }),
        metrics_(server_version()) {
    services_.limits = options.limits;
    services_.version = server_version();
    services_.data = options.data;
    if (!options.models.empty()) services_.atlases = options.models + "/families/atlas";
    services_.lab = options.lab;
    services_.web = options.web;
    services_.metrics = &metrics_;
    services_.memory = &memory_;
    services_.gate = &gate_;
    json::set_answer_limit(static_cast<std::size_t>(options.max_answer));
    http::ServerOptions http = options.http;
    http.memory = &memory_;
    http.headers = routes::security_headers();
    http.warn = [](const std::string& text) { spdlog::warn(text); };
    router_ = routes::make_router(services_);
    server_ = std::make_unique<http::Server>(
        http, router_, routes::problem_response,
        [this](const http::AnsweredRequest& answered) {
          metrics_.count_request(answered.pattern, answered.method, answered.status, answered.seconds);
          audit_.note(answered);
          if (options_.access_log) log_access(answered);
        },
        [](const std::string& text) { spdlog::error("unexpected exception in {}", text); },
        routes::make_guard({options.http.host, options.allowed_hosts, options.allowed_origins, &gate_}));
    services_.load = [this] { return server_->load(); };
  }

  int run() {
    const int port = server_->bind();
    std::atomic<bool> ended{false};
    // The server listens while the store opens, so that probes are answered from the start.
    std::thread listener([&] {
      server_->run();
      ended = true;
    });
    int status = 0;
    try {
      open();
      std::cout << "supple-server " << server_version() << " listens on http://" << host_in_url(options_.http.host)
                << ":" << port << std::endl;
      spdlog::info("ready: data in {}, {} models, {} workers, {} compute threads, {} connections", options_.data,
                   models_->size(), options_.jobs.workers, thread_count(), options_.http.max_connections);
      int signal = 0;
      sigwait(&signals_, &signal);
      drain();
      spdlog::info("signal {}: finishing within {} s", signal, options_.grace);
      constexpr double seconds_to_stop = 4;
      exit_after(options_.grace + seconds_to_stop);
    } catch (const std::exception& error) {
      spdlog::error("cannot start: {}", error.what());
      status = 1;
    }
    services_.stopping = true;
    server_->stop();
    if (jobs_) jobs_->shut_down(options_.grace);
    while (!ended) {
      server_->stop();  // repeated, because a call while `run` begins may be missed
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    listener.join();
    spdlog::info("stopped");
    return status;
  }

 private:
  /// Answers all requests for the time of --drain, but reports that the server is not ready, so that load balancers
  /// send no more requests. A further signal ends the wait.
  void drain() {
    if (options_.drain <= 0) return;
    spdlog::info("not ready any more; answering for another {} s", options_.drain);
    services_.draining = true;
    timespec time{};
    time.tv_sec = static_cast<std::time_t>(options_.drain);
    time.tv_nsec = static_cast<long>(1e9 * (options_.drain - static_cast<double>(time.tv_sec)));
    sigtimedwait(&signals_, nullptr, &time);
  }

  void open() {
    models_ = std::make_unique<store::ModelStore>(model_options(options_));  // it reads files while the store opens
    store_ = open_store();
    meshes_ = std::make_unique<store::MeshCache>(store_->meshes(), options_.mesh_memory);
    models_->wait_until_read();
    services_.store = store_.get();
    services_.meshes = meshes_.get();
    services_.models = models_.get();
    auto queue = options_.jobs;
    queue.memory = &memory_;
    queue.clean_up_too = [this] { remove_unused_meshes(); };
    jobs_ = std::make_unique<jobs::JobQueue>(
        *store_, queue, json::write_problem,
        [this](const store::JobRecord& job) {
          const double seconds = job.started ? static_cast<double>(job.finished - job.started) / 1000 : 0;
          metrics_.count_finished_job(job.kind, std::string(store::state_name(job.state)), seconds);
        },
        [](const std::string& text) { spdlog::error(text); },
        [this](const store::JobRecord& job, store::StoredRequest request, const Execution& execution) {
          services_.ready.wait(false);
          return routes::computation_of(router_, job, std::move(request), execution);
        });
    services_.jobs = jobs_.get();
    services_.ready = true;
    services_.ready.notify_all();
  }

  std::unique_ptr<store::Store> open_store() {
    const auto warn = [](const std::string& text) { spdlog::warn(text); };
    if (options_.database.empty())
      return std::make_unique<store::LocalStore>(options_.data, recovery_of_store(warn), quota());
    store::SharedStore::Options shared;
    shared.database = options_.database;
    shared.folder = options_.data;
    shared.lease = options_.lease;
    shared.quota = quota();
    shared.warn = warn;
    return std::make_unique<store::SharedStore>(shared);
  }

  store::Quota quota() {
    const auto bytes = options_.max_store > 0 ? options_.max_store : store::default_quota(options_.data);
    return {bytes, options_.max_mesh_bytes, [this](const std::string& owner) { return gate_.max_stored(owner); }};
  }

  void remove_unused_meshes() {
    if (options_.mesh_retention <= 0) return;
    const auto removed = meshes_->remove_unused(options_.mesh_retention);
    if (removed > 0) spdlog::info("{} meshes that nobody used are removed (--mesh-retention)", removed);
  }

  const ServerOptions& options_;
  const sigset_t signals_;
  budget::MemoryBudget memory_;
  access::Gate gate_;
  routes::AuditLog audit_{[](const std::string& line) { spdlog::info(line); }};
  metrics::Metrics metrics_;
  routes::Services services_;
  http::Router router_;
  std::unique_ptr<store::Store> store_;
  std::unique_ptr<store::MeshCache> meshes_;
  std::unique_ptr<store::ModelStore> models_;
  std::unique_ptr<jobs::JobQueue> jobs_;
  std::unique_ptr<http::Server> server_;  // last, because its handlers use all others
};

int serve(const ServerOptions& options) {
  start_log(options.log_level);
  const auto signals = block_end_signals();
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit of file size fails, but does not end the process
  budget::limit_arenas(static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
  set_thread_count(options.threads);
  if (!budget::counts_allocations()) spdlog::warn("what computations allocate is not held against --memory");
  if (options.helper.program.empty()) {
    spdlog::warn("no helper program: meshing runs in this process, where nothing stops it");
  } else {
    use_helper_processes(std::make_shared<HelperProcesses>(options.helper));
  }
  return Process(options, signals).run();
}

}  // namespace
}  // namespace supple

int main(int argc, char** argv) {
  if (const auto status = supple::run_command(argc, argv)) return *status;
  try {
    supple::ServerOptions options;
    if (const auto status = supple::read_options(argc, argv, options)) return *status;
    return supple::serve(options);
  } catch (const std::exception& error) {
    std::cerr << "supple-server: " << error.what() << '\n';
    return 1;
  }
}
