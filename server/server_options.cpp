#include "server_options.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <string_view>
#include <thread>

#include "commands.h"
#include "configuration_check.h"
#include "keys_command.h"
#include "option_sources.h"
#include "supple/budget/memory.h"
#include "supple/routes/guard.h"
#include "version.h"

namespace supple {
namespace {

/// The folder share/supple/`name` beside the folder of the program, in which an installed server finds its models and
/// its web editor. Empty if it does not exist.
std::string installed_folder(const std::string& name) {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return {};
  auto folder = program.parent_path().parent_path() / "share" / "supple" / name;
  return std::filesystem::is_directory(folder, error) ? folder.string() : std::string();
}

/// Sets the defaults that depend on the machine.
void set_computed_defaults(ServerOptions& options, const budget::MemoryDefaults& memory) {
  options.memory = memory.requests;
  options.request_memory = memory.request;
  options.mesh_memory = memory.meshes;
  options.helper.memory = static_cast<std::uint64_t>(memory.helper);
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  options.jobs.workers = cores;
  options.jobs.immediate = 2 * cores;
  options.models = installed_folder("models");
  options.web = installed_folder("web");
  options.helper.program = program_beside_this_one("supple-helper");
  options.lab.program = program_beside_this_one("supple-lab");
}

void add_place_options(CLI::App& app, ServerOptions& options) {
  app.add_option("--host", options.http.host, "Address to listen on");
  app.add_option("--port", options.http.port, "Port to listen on; 0 takes any free one, which is printed")
      ->check(CLI::Range(0, 65535));
  app.add_option("--data", options.data, "Folder of meshes, jobs and results; made if it does not exist");
  app.add_option("--database", options.database,
                 "PostgreSQL database that several servers share, with the folder --data: postgresql://user@host/name; "
                 "without it the server has a database of its own in that folder");
  app.add_option("--lease", options.lease,
                 "Seconds after which other servers of the same database take the jobs of one that is not heard of")
      ->check(CLI::Range(2.0, 3600.0));
  app.add_option("--models", options.models, "Folder of neural models (*.h5); it is looked at every two seconds")
      ->check(CLI::ExistingDirectory);
  app.add_option("--web", options.web, "Folder of the built web editor, which is read once and served at /")
      ->check(CLI::ExistingDirectory);
}

void add_work_options(CLI::App& app, ServerOptions& options) {
  app.add_option("--workers", options.jobs.workers, "Jobs that run at the same time, and as many in the background")
      ->check(CLI::Range(1, 1024));
  app.add_option("--immediate", options.jobs.immediate, "Immediate computations that run at the same time")
      ->check(CLI::Range(1, 1024));
  app.add_option("--threads", options.threads, "Threads that parallel computations share; 0: one for each core")
      ->check(CLI::Range(0, 1024));
  app.add_option("--idle-timeout", options.http.idle_seconds, "Seconds until a connection without requests is closed")
      ->check(CLI::PositiveNumber);
  app.add_option("--request-timeout", options.http.request_seconds, "Seconds that a request may take to arrive")
      ->check(CLI::PositiveNumber);
  app.add_option("--head-timeout", options.http.head_seconds, "Seconds that a request's head may take to arrive")
      ->check(CLI::PositiveNumber);
}

void add_access_options(CLI::App& app, ServerOptions& options) {
  app.add_option("--allowed-host", options.allowed_hosts,
                 "A name that clients may call the server by, besides those of loopback and --host; * for every name");
  app.add_option("--allowed-origin", options.allowed_origins,
                 "Origin of pages, besides the server's own, that may send requests: https://supple.example");
  app.add_option(
      "--keys", options.keys,
      "File of the keys that requests need; without it the file keys in the data folder. Keys are needed where "
      "the file exists, and always where --host is not of loopback");
  app.add_flag("--open", options.open,
               "Answer everybody who reaches the server, without a key: they read, compute and delete what they like");
  app.add_flag("--access-log", options.access_log, "Log a line for each answered request");
}

void add_ending_and_helper_options(CLI::App& app, ServerOptions& options) {
  app.add_option(
         "--drain", options.drain,
         "Seconds after SIGTERM in which the server answers all requests but /readyz, which tells load balancers "
         "to ask others")
      ->check(CLI::Range(0.0, 3600.0));
  app.add_option("--grace", options.grace, "Seconds that running computations get to finish at SIGTERM")
      ->check(CLI::NonNegativeNumber);
  app.add_option(
         "--helper", options.helper.program,
         "Program that meshes, clips and reads models in processes of its own, which can be stopped and may fail; "
         "'' does it here")
      ->check(CLI::ExistingFile | CLI::IsMember({""}));
  app.add_option("--lab", options.lab.program,
                 "Program supple-lab, which trains networks; none: networks are not trained")
      ->check(CLI::ExistingFile | CLI::IsMember({""}));
  app.add_option("--lab-memory", options.lab.memory, "Bytes of address space of a training; 0: no limit")
      ->transform(CLI::AsSizeValue(false));
  app.add_option("--max-training", options.limits.max_training, "Seconds that a training may ask for")
      ->check(CLI::PositiveNumber);
  app.add_option("--helper-memory", options.helper.memory, "Bytes of address space of a helper process; 0: no limit")
      ->transform(CLI::AsSizeValue(false));
  app.add_option("--log-level", options.log_level, "What is logged")
      ->check(CLI::IsMember({"debug", "info", "warn", "error", "off"}));
}

void add_limits(CLI::App& app, ServerOptions& options) {
  auto* const group = app.add_option_group("Limits", "A problem about a limit names the option that sets it");
  auto& limits = options.limits;
  group->add_option("--max-body", limits.max_body, "Bytes of a mesh file")->transform(CLI::AsSizeValue(false));
  group->add_option("--max-json", limits.max_json, "Bytes of a JSON body")->transform(CLI::AsSizeValue(false));
  group->add_option("--max-json-values", limits.json.max_values, "Values in a JSON body");
  group->add_option("--max-vertices", limits.mesh.vertices, "Vertices of a mesh")->check(CLI::PositiveNumber);
  group->add_option("--max-faces", limits.mesh.faces, "Faces of a mesh")->check(CLI::PositiveNumber);
  group->add_option("--max-pairs", limits.json.max_pairs, "Pairs of a geodesics request");
  group->add_option("--max-points", limits.json.max_points,
                    "Points of a mean or a network, sources of a field, sites of a diagram");
  group->add_option("--max-springs", limits.json.max_springs, "Springs of a network");
  group->add_option("--max-states", limits.json.max_states, "States of a load path");
  group->add_option("--max-strains", limits.json.max_strains, "Strains of an evaluation of a model");
  group->add_option("--max-mesh-nodes", limits.json.max_mesh_nodes, "Nodes of the mesh of one cell of a structure")
      ->check(CLI::PositiveNumber);
  group->add_option("--max-deadline", limits.json.max_deadline, "Seconds that a computation may ask for")
      ->check(CLI::PositiveNumber);
  group->add_option("--default-deadline", limits.json.default_deadline, "Seconds for a computation that does not say")
      ->check(CLI::PositiveNumber);
  group->add_option("--max-connections", options.http.max_connections, "Connections at the same time")
      ->check(CLI::Range(1, 100000));
  group
      ->add_option("--max-requests", options.http.max_requests,
                   "Requests that are answered at the same time, a thread each, and as many in the background")
      ->check(CLI::Range(1, 10000));
  group
      ->add_option("--client-share", options.http.max_client_fraction,
                   "Share of connections and requests that one client may have")
      ->check(CLI::Range(0.01, 1.0));
  group
      ->add_option(
          "--memory", options.memory,
          "Bytes that requests and computations may take together; half of the machine's, control group's or process's")
      ->transform(CLI::AsSizeValue(false));
  group->add_option("--max-request-memory", options.request_memory, "Bytes that one request may take")
      ->transform(CLI::AsSizeValue(false));
  group->add_option("--max-answer", options.max_answer, "Bytes of an answer in JSON")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::Range(65536.0, 1e15));
  group
      ->add_option("--event-streams", limits.event_streams, "Event streams at the same time (each is a connection too)")
      ->check(CLI::NonNegativeNumber);
  group->add_option("--max-queue", options.jobs.max_queue,
                    "Jobs that wait for a worker, and as many in the background");
  group
      ->add_option("--max-queue-bytes", options.jobs.max_queue_bytes,
                   "Bytes that the requests of jobs hold which wait, and as many in the background")
      ->transform(CLI::AsSizeValue(false));
  group->add_option("--max-jobs", options.jobs.max_jobs, "Finished jobs that are kept");
  group
      ->add_option(
          "--max-attempts", options.jobs.max_attempts,
          "Attempts to run a job that the server ends in without being told to, since the job last saved something")
      ->check(CLI::Range(1, 1000));
  group->add_option("--retention", options.jobs.retention, "Seconds that a finished job is kept")
      ->check(CLI::PositiveNumber);
  group->add_option("--max-model", options.max_model, "Bytes of a model file")->transform(CLI::AsSizeValue(false));
  group
      ->add_option("--min-free", limits.min_free,
                   "Bytes that the disk of the data folder has left while the server calls itself ready")
      ->transform(CLI::AsSizeValue(false));
  group->add_option("--max-store", options.max_store, "Bytes of the data folder; 0: nine tenths of its disk")
      ->transform(CLI::AsSizeValue(false));
  group->add_option("--max-mesh-bytes", options.max_mesh_bytes, "Bytes of stored meshes; 0: no limit of their own")
      ->transform(CLI::AsSizeValue(false));
  group
      ->add_option("--mesh-retention", options.mesh_retention,
                   "Seconds that a mesh is kept which nobody uses; 0: until it is deleted")
      ->check(CLI::NonNegativeNumber);
  group->add_option("--mesh-memory", options.mesh_memory, "Bytes of meshes held in memory (an estimate)")
      ->transform(CLI::AsSizeValue(false));
}

/// Exit status if the configuration cannot be used.
constexpr int unusable_status = 2;

/// Descriptions of the defaults that depend on the machine, by option.
std::map<std::string, std::string> computed_defaults() {
  return {{"--models", "`share/supple/models` beside the folder of the program, if there is one"},
          {"--web", "`share/supple/web` beside the folder of the program, if there is one"},
          {"--keys", "the file `keys` in the data folder"},
          {"--workers", "one for each core"},
          {"--immediate", "two for each core"},
          {"--helper", "`supple-helper` beside the program, if it is there"},
          {"--lab", "`supple-lab` beside the program, if it is there"},
          {"--helper-memory", "a quarter of the memory, 8 GiB at most"},
          {"--memory", "half of the memory"},
          {"--max-request-memory", "a quarter of the memory, 1 GiB at least"},
          {"--mesh-memory", "an eighth of the memory, 2 GiB at most"}};
}

/// Options about the process itself, which a configuration file cannot set.
struct ProcessOptions {
  std::string config;
  bool check = false;
  bool table = false;
};

void add_process_options(CLI::App& app, ProcessOptions& process_options) {
  auto* const group = app.add_option_group(
      "Configuration",
      "Each option can also be set by a variable of the environment (SUPPLE_MAX_STORE for --max-store) and by a file. "
      "The command line counts most, then the environment, then the file");
  group
      ->add_option("--config", process_options.config,
                   "File of lines \"max-store = 1e9\"; without it that of SUPPLE_CONFIG")
      ->configurable(false);
  group
      ->add_flag("--check-config", process_options.check,
                 "Look whether a server could start with this configuration, show it, and end: 0 if it could, else 2")
      ->configurable(false);
  group->add_flag("--help-config", process_options.table, "Print a table of all options and their names")
      ->configurable(false);
}

bool asks_for(int argc, char** argv, std::string_view option) {
  return std::any_of(argv + 1, argv + argc, [&](const char* argument) { return argument == option; });
}

void print_faults(const std::vector<std::string>& faults) {
  for (const auto& fault : faults) std::cerr << "supple-server: " << fault << '\n';
}

/// Reads the configuration file and the environment, and prints what is wrong with them. Returns false if the server
/// cannot start with them.
bool read_file_and_environment(int argc, char** argv, OptionSources& sources) {
  // Help and version are printed even if the configuration file is invalid.
  if (!asks_for(argc, argv, "--help") && !asks_for(argc, argv, "-h") && !asks_for(argc, argv, "--version")) {
    if (const auto path = config_path(argc, argv); !path.empty()) sources.read_file(path);
    sources.read_environment(environ);
  }
  for (const auto& warning : sources.warnings()) std::cerr << "supple-server: warning: " << warning << '\n';
  print_faults(sources.faults());
  return sources.faults().empty();
}

/// Prints the configuration and its faults. Returns the exit status.
int check_configuration(const OptionSources& sources, const ServerOptions& options) {
  sources.print_effective(std::cout);
  const auto faults = configuration_faults(options);
  print_faults(faults);
  if (!faults.empty()) return unusable_status;
  std::cout << "# A server can start with this configuration." << std::endl;
  return 0;
}

}  // namespace

access::Rule ServerOptions::rule_of_keys() const {
  if (open) return access::Rule::never;
  return routes::is_loopback(http.host) ? access::Rule::where_keys_are : access::Rule::always;
}

std::optional<int> read_options(int argc, char** argv, ServerOptions& options) {
  const auto memory = budget::memory_defaults(budget::memory_limits());
  set_computed_defaults(options, memory);
  CLI::App app(
      "Answers requests for geodesics on triangle meshes, for simulations of periodic structures and for what neural "
      "models know of them.",
      "supple-server");
  app.option_defaults()->always_capture_default();
  app.footer(command_list());
  app.set_version_flag("--version", std::string("supple-server ") + server_version());
  add_place_options(app, options);
  add_work_options(app, options);
  add_access_options(app, options);
  add_ending_and_helper_options(app, options);
  add_limits(app, options);
  ProcessOptions process_options;
  add_process_options(app, process_options);
  OptionSources sources(app, argc, argv, computed_defaults());
  if (asks_for(argc, argv, "--help-config")) {
    sources.print_table(std::cout);
    return 0;
  }
  if (!read_file_and_environment(argc, argv, sources)) return unusable_status;
  add_keys_commands(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int status = app.exit(error);
    return status != 0 && asks_for(argc, argv, "--check-config") ? unusable_status : status;
  }
  if (!app.get_subcommands().empty()) return 0;
  if (process_options.check) return check_configuration(sources, options);
  // The limit of the process is at least what the options allow for requests and loaded meshes together.
  options.process_memory = std::max(memory.process, options.memory + options.mesh_memory);
  return std::nullopt;
}

}  // namespace supple
