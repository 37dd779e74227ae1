#include "dataset_commands.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <charconv>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "family_option.h"
#include "progress_line.h"
#include "supple/base/error.h"
#include "supple/base/threads.h"
#include "supple/dataset/dataset_file.h"
#include "supple/dataset/journal.h"
#include "supple/dataset/merge.h"
#include "supple/lab/dataset_maker.h"
#include "supple/lab/dataset_options.h"
#include "supple/lab/dataset_report.h"

namespace supple::lab {
namespace {

using microscale::Law;
using microscale::Refinement;
using microscale::Switch;

const std::map<std::string, Switch> switches{
    {"automatic", Switch::automatic}, {"on", Switch::on}, {"off", Switch::off}};
const std::map<std::string, Refinement> refinements{
    {"off", Refinement::off}, {"estimated", Refinement::estimated}, {"extrapolated", Refinement::extrapolated}};
const std::map<std::string, tiling::Region> regions{
    {"automatic", tiling::Region::automatic}, {"tile", tiling::Region::tile}, {"cell", tiling::Region::cell}};
const std::map<std::string, Law> laws{{"neo_hookean", Law::neo_hookean},
                                      {"incompressible_plane_stress", Law::incompressible_plane_stress}};
const std::map<std::string, PlanKind> plans{
    {"sequence", PlanKind::sequence}, {"grid", PlanKind::grid}, {"rest", PlanKind::rest}};

/// Adds an option whose values have names.
template <class T>
CLI::Option* add_choice(CLI::App& command, const std::string& name, T& value, const std::map<std::string, T>& choices,
                        const std::string& about) {
  return command
      .add_option_function<std::string>(
          name, [&value, &choices](const std::string& text) { value = choices.at(text); }, about)
      ->check(CLI::IsMember(&choices));
}

struct MakeArguments {
  DatasetOptions options;
  FamilyOption family;
  std::string shard = "0/1";
  std::filesystem::path out;
  int threads = 0;
  bool quiet = false;
  const CLI::Option* designs = nullptr;  ///< the option of their number, to see whether it was given
};

/// Reads a shard k/n, where 0 <= k < n.
void read_shard(const std::string& text, DatasetOptions& options) {
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, options.shard);
  if (first.ec == std::errc() && first.ptr != end && *first.ptr == '/') {
    const auto second = std::from_chars(first.ptr + 1, end, options.shards);
    if (second.ec == std::errc() && second.ptr == end) return;
  }
  throw Error("dataset.invalid_option", "shard must be k/n with whole numbers, 0 <= k < n, got " + text + ".",
              {{"shard", "k/n, e.g. 0/4 for the first of four"}});
}

void add_options(CLI::App& command, MakeArguments& arguments) {
  DatasetOptions& options = arguments.options;
  add_family_options(command, arguments.family);
  command.add_option("--out", arguments.out, "The HDF5 file; until it is complete, OUT.partial keeps what is done")
      ->required();
  arguments.designs =
      command.add_option("--designs", options.designs, "Number of designs, over all shards")->capture_default_str();
  command.add_option("--first", options.first, "Index of the first design in the sequence")->capture_default_str();
  command.add_option("--seed", options.seed, "Of the sequence of designs and loads")->capture_default_str();
  command.add_option("--shard", arguments.shard, "k/n: only designs with index mod n = k")->capture_default_str();
  command.add_option("--threads", arguments.threads, "Designs at work at once; 0: one for each core")
      ->capture_default_str();
  command.add_flag("--quiet", arguments.quiet, "No progress on stderr");
  command.add_option("--margin", options.box_margin, "Share by which the box of parameters is widened on either side")
      ->capture_default_str();
  command.add_option("--part-lower", options.part_lower, "Designs of this part of the box only: p1,p2,...")
      ->delimiter(',');
  command.add_option("--part-upper", options.part_upper, "The part's other end: p1,p2,...")->delimiter(',');
  command.add_option("--corners", options.corners, "Begin with the corners of the box (1 or 0)")->capture_default_str();
  command.add_option("--parameters", options.parameters, "One design instead of a sequence: p1,p2,...")->delimiter(',');
  command
      .add_option("--list", options.list,
                  "Designs instead of a sequence: the parameters of one after another, p1,p2,p1,p2,...")
      ->delimiter(',');
  command.add_option("--directions", options.directions, "Direction of the first paths of each listed design, radians")
      ->delimiter(',');
}

void add_load_options(CLI::App& command, LoadPlanOptions& loads) {
  const std::string group = "Loads of each design";
  const auto load = [&](const char* name, auto& value, const char* about) {
    command.add_option(name, value, about)->capture_default_str()->group(group);
  };
  add_choice(command, "--plan", loads.kind, plans,
             "sequence: a few paths for each design; grid: the published grid; rest: the state of rest alone")
      ->group(group);
  load("--tension-paths", loads.tension_paths, "Uniaxial tension paths");
  load("--compression-paths", loads.compression_paths, "Uniaxial compression paths");
  load("--biaxial-paths", loads.biaxial_paths, "Biaxial paths");
  load("--tension-states", loads.tension_states, "States of a tension path");
  load("--compression-states", loads.compression_states, "States of a compression path");
  load("--biaxial-states", loads.biaxial_states, "States of a biaxial path");
  load("--largest-stretch", loads.max_stretch, "End of tension paths");
  load("--smallest-stretch", loads.min_stretch, "End of compression paths");
  load("--largest-biaxial-stretch", loads.max_biaxial_stretch, "Upper end of biaxial stretches");
  load("--smallest-biaxial-stretch", loads.min_biaxial_stretch, "Lower end of biaxial stretches");
  load("--first-strain", loads.first_strain, "No state is nearer to rest than this");
}

void add_simulation_options(CLI::App& command, microscale::SimulationOptions& simulation) {
  const std::string group = "Simulation";
  const auto plain = [&](const char* name, auto& value, const char* about) {
    command.add_option(name, value, about)->capture_default_str()->group(group);
  };
  const auto effect = [&](const char* name, Switch& value, const char* about) {
    add_choice(command, name, value, switches, about)->group(group);
  };
  plain("--mesh-size", simulation.mesh.mesh_size, "Length of a triangle's side over the beam width");
  plain("--corner-size", simulation.mesh.corner_size, "Size at re-entrant corners over the size elsewhere");
  add_choice(command, "--refinement", simulation.refinement, refinements,
             "Each state once more on a finer mesh: extrapolated takes off what the mesh errs by")
      ->group(group);
  add_choice(command, "--mesh-region", simulation.mesh.region, regions, "What is meshed at once")->group(group);
  plain("--max-nodes", simulation.mesh.max_nodes, "Largest mesh");
  plain("--tolerance", simulation.tolerance, "Residual of an equilibrium");
  plain("--max-iterations", simulation.max_iterations, "Newton iterations of one load step");
  plain("--max-load-step", simulation.max_load_step, "Largest change of F in one load step");
  plain("--youngs-modulus", simulation.material.youngs_modulus, "MPa");
  plain("--poisson-ratio", simulation.material.poisson_ratio, "Of the neo-Hookean law");
  add_choice(command, "--law", simulation.material.law, laws, "Of the solid")->group(group);
  effect("--contact", simulation.contact, "Self-contact");
  effect("--patch", simulation.patch, "Two-by-two cells");
  effect("--buckling", simulation.buckling, "Leaving unstable branches");
  plain("--tangents", simulation.tangents, "Compute tangents (1 or 0)");
}

void make(MakeArguments& arguments, const StopSignals& signals, bool& interrupted) {
  set_family(arguments.family, arguments.options);
  read_shard(arguments.shard, arguments.options);
  if (!arguments.options.parameters.empty()) arguments.options.designs = 1;
  if (!arguments.options.list.empty() && arguments.designs->count() == 0) {
    const std::size_t parameters = family_of(arguments.options).parameters.size();
    arguments.options.designs =
        static_cast<std::int64_t>(arguments.options.list.size() / parameters) - arguments.options.first;
  }
  set_thread_count(arguments.threads);
  MakeResult result;
  {
    ProgressLine progress(arguments.quiet);
    result = make_dataset(arguments.options, arguments.out, signals.cancellation(), &progress);
  }
  interrupted = !result.finished;
  if (result.finished)
    fmt::print("{} holds {} designs, {} of them computed now\n", arguments.out.string(), result.designs,
               result.computed);
  else
    fmt::print(stderr, "interrupted: {} holds {} designs; the same command goes on\n",
               dataset::journal_path(arguments.out).string(), result.designs);
}

struct RenewArguments {
  std::filesystem::path old;
  std::filesystem::path out;
  RenewOptions options;
  int threads = 0;
  bool quiet = false;
};

void renew(const RenewArguments& arguments, const StopSignals& signals, bool& interrupted) {
  set_thread_count(arguments.threads);
  RenewResult result;
  {
    ProgressLine progress(arguments.quiet);
    result = renew_dataset(dataset::read_dataset(arguments.old), arguments.options, arguments.out,
                           signals.cancellation(), &progress);
  }
  interrupted = !result.finished;
  if (result.finished)
    fmt::print("{} holds {} designs, {} of them simulated anew now\n", arguments.out.string(), result.designs,
               result.renewed);
  else
    fmt::print(stderr, "interrupted: {} holds {} designs; the same command goes on\n",
               dataset::journal_path(arguments.out).string(), result.designs);
}

struct MergeArguments {
  std::vector<std::filesystem::path> files;
  std::filesystem::path out;
  std::string precision = "double";
  bool uncompressed = false;
  bool allow_missing = false;
};

void merge(const MergeArguments& arguments) {
  std::vector<dataset::Dataset> parts;
  for (const auto& file : arguments.files) parts.push_back(dataset::read_finished_or_partial(file));
  const auto merged = dataset::merge(std::move(parts), arguments.allow_missing);
  dataset::write_dataset(arguments.out, merged, {arguments.precision == "single", !arguments.uncompressed});
  fmt::print("{} holds {} designs\n", arguments.out.string(), merged.designs.size());
}

}  // namespace

void add_dataset_commands(CLI::App& program, const StopSignals& signals, bool& interrupted) {
  CLI::App* group = program.add_subcommand("dataset", "Make, merge and describe data sets");
  group->require_subcommand(1);

  const auto make_arguments = std::make_shared<MakeArguments>();
  CLI::App* maker =
      group->add_subcommand("make", "Simulate designs of a family; interrupted, the same command goes on");
  add_options(*maker, *make_arguments);
  add_load_options(*maker, make_arguments->options.loads);
  add_simulation_options(*maker, make_arguments->options.simulation);
  maker->callback([=, &signals, &interrupted] { make(*make_arguments, signals, interrupted); });

  const auto renew_arguments = std::make_shared<RenewArguments>();
  CLI::App* renewer = group->add_subcommand(
      "renew", "Simulate anew the designs of a data set whose response has changed with the engine");
  renewer->add_option("file", renew_arguments->old, "Finished data set")->required();
  renewer
      ->add_option("--out", renew_arguments->out, "The HDF5 file; until it is complete, OUT.partial keeps what is done")
      ->required();
  renewer->add_option("--tolerance", renew_arguments->options.tolerance, "Relative change of the stress next to rest")
      ->capture_default_str();
  renewer->add_flag("--contacts", renew_arguments->options.contacts, "Designs with states in contact in any case");
  renewer->add_option("--threads", renew_arguments->threads, "Designs at work at once; 0: one for each core")
      ->capture_default_str();
  renewer->add_flag("--quiet", renew_arguments->quiet, "No progress on stderr");
  renewer->callback([=, &signals, &interrupted] { renew(*renew_arguments, signals, interrupted); });

  const auto rest_arguments = std::make_shared<MakeArguments>();
  rest_arguments->options = rest_options();
  CLI::App* rest = group->add_subcommand(
      "rest", "Stiffness at rest of many designs, a linear solve each; interrupted, the same command goes on");
  add_options(*rest, *rest_arguments);
  add_simulation_options(*rest, rest_arguments->options.simulation);
  rest->callback([=, &signals, &interrupted] { make(*rest_arguments, signals, interrupted); });

  const auto merge_arguments = std::make_shared<MergeArguments>();
  CLI::App* merger = group->add_subcommand("merge", "Make one data set of several with the same recipe");
  merger->add_option("files", merge_arguments->files, "Shards, finished or (with --allow-missing) not")->required();
  merger->add_option("--out", merge_arguments->out, "The merged file")->required();
  merger->add_option("--precision", merge_arguments->precision, "Of the rows: double or single")
      ->check(CLI::IsMember({"double", "single"}))
      ->capture_default_str();
  merger->add_flag("--uncompressed", merge_arguments->uncompressed, "Do not deflate");
  merger->add_flag("--allow-missing", merge_arguments->allow_missing, "Accept that designs are missing");
  merger->callback([=] { merge(*merge_arguments); });

  const auto info_file = std::make_shared<std::filesystem::path>();
  CLI::App* info = group->add_subcommand("info", "What a data set is and how to make it again; unfinished ones too");
  info->add_option("file", *info_file, "Data set")->required();
  info->callback([=] { fmt::print("{}", describe(dataset::read_finished_or_partial(*info_file))); });

  const auto report_file = std::make_shared<std::filesystem::path>();
  const auto max_failures = std::make_shared<int>(50);
  CLI::App* reporter = group->add_subcommand("report", "What came of it: rows, failures, cost; unfinished ones too");
  reporter->add_option("file", *report_file, "Data set")->required();
  reporter->add_option("--failures", *max_failures, "Failures listed one by one, of each kind")->capture_default_str();
  reporter->callback([=] { fmt::print("{}", report(dataset::read_finished_or_partial(*report_file), *max_failures)); });
}

}  // namespace supple::lab
