#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "commands.h"
#include "failure.h"
#include "idle_options.h"
#include "numbers.h"
#include "style.h"
#include "surface_point.h"
#include "units.h"

namespace supple::cli {
namespace {

constexpr const char* diagrams_path = "/v1/voronoi-diagrams";
constexpr const char* optimizations_path = "/v1/voronoi-optimizations";

struct VoronoiArguments {
  std::string mesh;
  std::vector<std::string> sites;
  std::string sites_file;
  std::string progress_file;
  std::string method;
  double relative_error = 0;
  std::string objectives;
  double target_length = 0;
  std::string fixed;
  std::string minimizer;
  double tolerance = 0;
  double border_deviation = 0;
  double panel_scale = 0;
  double deadline = 0;
  std::string obj_file;
  std::string vtu_file;
  std::string svg_file;
  std::string csv_file;
  int random = 0;
  int seed = -1;
  int max_iterations = 0;
  bool history = false;

  std::array<std::pair<const std::string*, const char*>, 4> files() const {
    return {{{&obj_file, "model/obj"},
             {&vtu_file, "application/x-vtu+xml"},
             {&svg_file, "image/svg+xml"},
             {&csv_file, "text/csv"}}};
  }
};

nlohmann::json sites_in_file(const std::string& file) {
  auto document = object_in_file(file);
  if (!document.contains("sites")) throw Failure(ExitCode::local_file, fmt::format("{} has no field sites", file));
  return document.at("sites");
}

nlohmann::json voronoi_sites(const VoronoiArguments& arguments) {
  const int sources = static_cast<int>(!arguments.sites.empty()) + static_cast<int>(arguments.random > 0) +
                      static_cast<int>(!arguments.sites_file.empty());
  if (sources != 1) throw Failure(ExitCode::usage, "give sites, or one of --random and --sites");
  if (std::error_code ignored; std::filesystem::is_regular_file(arguments.progress_file, ignored))
    return sites_in_file(arguments.progress_file);
  if (!arguments.sites_file.empty()) return sites_in_file(arguments.sites_file);
  if (arguments.random > 0) {
    nlohmann::json random = {{"count", arguments.random}};
    if (arguments.seed >= 0) random["seed"] = arguments.seed;
    return random;
  }
  nlohmann::json sites = nlohmann::json::array();
  for (const auto& site : arguments.sites) sites.push_back(parse_surface_point(site));
  return sites;
}

/// Objectives with their weights, from "centroidal" or "edge_length=1,planarity=0.5"; the default weight is 1.
nlohmann::json voronoi_objectives(const std::string& text) {
  nlohmann::json objectives = nlohmann::json::object();
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string part = text.substr(at, end - at);
    const std::size_t equals = part.find('=');
    if (equals == 0 || part.empty())
      throw Failure(ExitCode::usage, fmt::format("'{}' names no objectives: NAME[=WEIGHT][,NAME[=WEIGHT]]...", text));
    objectives[part.substr(0, equals)] =
        equals == std::string::npos ? 1.0 : parse_number(part.substr(equals + 1), "weight of an objective");
    at = end + 1;
  }
  return objectives;
}

nlohmann::json diagram_request(const VoronoiArguments& arguments) {
  nlohmann::json request = {{"sites", voronoi_sites(arguments)}};
  if (!arguments.method.empty()) request["accuracy"]["method"] = arguments.method;
  if (arguments.relative_error > 0) {
    request["accuracy"]["relative_error"] = arguments.relative_error;
    if (arguments.method.empty()) request["accuracy"]["method"] = "bounded";
  }
  if (arguments.border_deviation > 0) request["accuracy"]["border_deviation"] = arguments.border_deviation;
  if (arguments.panel_scale > 0) request["panel_scale"] = arguments.panel_scale;
  if (arguments.deadline > 0) request["deadline"] = arguments.deadline;
  return request;
}

nlohmann::json optimization_request(const VoronoiArguments& arguments) {
  if (!arguments.method.empty() || arguments.relative_error > 0)
    throw Failure(ExitCode::usage,
                  "diagrams are optimized by exact distances: leave out --method and --relative-error");
  nlohmann::json request = {{"sites", voronoi_sites(arguments)},
                            {"objectives", voronoi_objectives(arguments.objectives)}};
  if (!arguments.progress_file.empty() && arguments.target_length == 0 && request["objectives"].contains("edge_length"))
    throw Failure(ExitCode::usage,
                  "--continue with edge_length needs --target-length, which would be another one after each start");
  if (arguments.target_length > 0) request["target_length"] = arguments.target_length;
  if (!arguments.fixed.empty()) request["fixed_sites"] = parse_indices(arguments.fixed, "site");
  if (!arguments.minimizer.empty()) request["method"] = arguments.minimizer;
  if (arguments.tolerance > 0) request["accuracy"]["tolerance"] = arguments.tolerance;
  if (arguments.border_deviation > 0) request["accuracy"]["border_deviation"] = arguments.border_deviation;
  if (arguments.max_iterations > 0) request["max_iterations"] = arguments.max_iterations;
  if (arguments.deadline > 0) request["deadline"] = arguments.deadline;
  return request;
}

constexpr std::array<std::pair<const char*, const char*>, 4> spreads{{{"edge_length", "edge length"},
                                                                      {"planarity", "off the plane"},
                                                                      {"area", "cell area"},
                                                                      {"vertex_distance", "vertex / site"}}};

void print_spread(const std::string& name, const nlohmann::json& spread) {
  fmt::print("{:<24}", name);
  for (const char* column : {"mean", "least", "greatest", "deviation"})
    fmt::print("  {:>12.6g}", spread.at(column).get<double>());
  fmt::print("\n");
}

void print_statistics(const nlohmann::json& answer) {
  const auto& statistics = answer.at("statistics");
  fmt::print("{:<24}  {:>12}  {:>12}  {:>12}  {:>12}\n", "", "mean", "least", "greatest", "deviation");
  for (const auto& [key, name] : spreads) {
    if (!statistics.contains("before")) {
      print_spread(name, statistics.at(key));
      continue;
    }
    print_spread(fmt::format("{}, before", name), statistics.at("before").at(key));
    print_spread(fmt::format("{}, after", name), statistics.at("after").at(key));
  }
}

void print_optimization(const nlohmann::json& answer, bool history) {
  fmt::print("energy      {:.12g}\n", answer.at("energy").get<double>());
  for (const auto& term : answer.at("terms"))
    fmt::print("  {:<18}{:.12g}\n", term.at("name").get<std::string>(), term.at("energy").get<double>());
  fmt::print("|gradient|  {:.3e} (asked for {:.3e})\n", answer.at("gradient_norm").get<double>(),
             answer.at("accuracy").at("gradient_tolerance").get<double>());
  fmt::print("stopped     {} after {} iterations\n", answer.at("stopped").get<std::string>(),
             answer.at("iterations").get<int>());
  if (const auto moves = answer.find("site_moves"); moves != answer.end())
    fmt::print("site moves  {} tried in {} passes, {} taken; steps for all sites ended {} times, first at {:.9g}\n",
               moves->at("tried").get<std::int64_t>(), moves->at("passes").get<int>(),
               moves->at("taken").get<std::int64_t>(), moves->at("held_searches").get<int>(),
               moves->at("energy_before").get<double>());
  if (!history) return;
  fmt::print("{:>4}  {:>16}  {:>12}  {:>12}\n", "step", "energy", "|gradient|", "moved");
  const auto& states = answer.at("history");
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto& state = states.at(i);
    fmt::print("{:>4}  {:>16.9g}  {:>12.3e}  {:>12.3e}\n", i, state.at("energy").get<double>(),
               state.at("gradient_norm").get<double>(), state.at("step_length").get<double>());
  }
}

void print_diagram(const nlohmann::json& answer, bool history) {
  fmt::print("diagram     {} cells, {} edges, {} vertices\n", answer.at("cells").size(), answer.at("edges").size(),
             answer.at("vertices").size());
  if (answer.contains("stopped")) print_optimization(answer, history);
  if (answer.at("unreached_area").get<double>() > 0)
    fmt::print("no site     on an area of {:.6g}\n", answer.at("unreached_area").get<double>());
  print_statistics(answer);
  print_points_in_space(answer);
  for (const auto& warning : answer.at("warnings"))
    fmt::print("{}     {}\n", styled("warning", Style::warning), warning.get<std::string>());
  fmt::print("took        {:.4g} s\n", answer.at("cost").at("seconds").get<double>());
}

/// Saves the sites of the latest iteration in a file. The server does not report them if there are too many.
void save_progress(const std::string& file, const nlohmann::json& job) {
  const auto partial = job.find("partial");
  if (partial == job.end() || !partial->contains("sites")) return;
  const nlohmann::json progress = {{"iteration", partial->at("iteration")}, {"sites", partial->at("sites")}};
  replace_file(file, progress.dump());
}

void check_effects(const CLI::App& command, const VoronoiArguments& arguments) {
  const bool optimized = !arguments.objectives.empty();
  constexpr const char* alone = "without --optimize";
  refuse_idle_options(
      command,
      {{"--continue", optimized, alone},
       {"--target-length", optimized && voronoi_objectives(arguments.objectives).contains("edge_length"),
        "without edge_length among the objectives of --optimize"},
       {"--fixed", optimized, alone},
       {"--minimizer", optimized, alone},
       {"--tolerance", optimized, alone},
       {"--max-iterations", optimized, alone},
       {"--history", optimized, alone},
       {"--seed", arguments.random > 0, "without --random"},
       {"--panel-scale", !arguments.svg_file.empty() || !arguments.csv_file.empty(), "without --svg or --csv"}});
}

void run(const GlobalOptions& options, const VoronoiArguments& arguments) {
  const bool optimized = !arguments.objectives.empty();
  auto request = optimized ? optimization_request(arguments) : diagram_request(arguments);
  Session session(options);
  request["mesh"] = session.mesh_id(arguments.mesh);
  if (!arguments.progress_file.empty())
    session.set_observer([&arguments](const nlohmann::json& job) { save_progress(arguments.progress_file, job); });
  const nlohmann::json answer = session.compute(optimized ? optimizations_path : diagrams_path, request).json();
  session.set_observer({});
  if (!arguments.progress_file.empty())
    replace_file(arguments.progress_file,
                 nlohmann::json{{"iteration", answer.at("iterations")}, {"sites", answer.at("sites")}}.dump());
  // The files of an optimized diagram are those of its final sites, without another optimization.
  nlohmann::json drawn = optimized ? nlohmann::json{{"mesh", request["mesh"]}} : request;
  drawn["sites"] = answer.at("sites");
  if (arguments.panel_scale > 0) drawn["panel_scale"] = arguments.panel_scale;
  if (arguments.border_deviation > 0) drawn["accuracy"]["border_deviation"] = arguments.border_deviation;
  bool on_terminal = false;
  for (const auto& [file, media_type] : arguments.files()) {
    if (file->empty()) continue;
    on_terminal |= *file == "-";
    write_file(*file, session.compute(diagrams_path, drawn, media_type).body);
  }
  if (on_terminal) return;
  session.json() ? print_json(answer) : print_diagram(answer, arguments.history);
}

void add_optimization_options(CLI::App& command, VoronoiArguments& arguments) {
  command.add_option("--optimize", arguments.objectives,
                     "Move the sites until these objectives are small: edge_length, planarity, regularity, centroidal, "
                     "equal_area; NAME[=WEIGHT][,NAME[=WEIGHT]]...");
  command.add_option("--target-length", arguments.target_length, "Of all edges, in mesh units (the mean at the start)")
      ->check(CLI::PositiveNumber);
  command.add_option("-f,--fixed", arguments.fixed, "Sites that stay where they are: indices separated by commas");
  command.add_option("--minimizer", arguments.minimizer, "How to optimize (automatic)")
      ->check(CLI::IsMember({"automatic", "gauss_newton", "lbfgs"}));
  command
      .add_option("-t,--tolerance", arguments.tolerance,
                  "Stop once |gradient| <= tolerance * root of the sites' number / mean cell size (1e-6)")
      ->check(CLI::PositiveNumber);
  command.add_option("--max-iterations", arguments.max_iterations, "Give up after so many (100)")
      ->check(CLI::PositiveNumber);
  command.add_option(
      "--continue", arguments.progress_file,
      "Keep the sites on their way in this file, and go on from them where it is there already: after an "
      "interruption, give the same command again");
  command.add_flag("--history", arguments.history, "Show every iteration");
}

}  // namespace

void add_voronoi_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<VoronoiArguments>();
  CLI::App* command =
      program.add_subcommand("voronoi", "The geodesic Voronoi diagram of sites on the surface, as it is or optimized");
  command->add_option("mesh", arguments->mesh, "Mesh")->required();
  command->add_option("sites", arguments->sites, "The sites, in their order");
  command->add_option("--random", arguments->random, "So many random sites, spread evenly over the area")
      ->check(CLI::PositiveNumber);
  command->add_option("--seed", arguments->seed, "Of the random sites (1)")->check(CLI::NonNegativeNumber);
  command->add_option("--sites", arguments->sites_file,
                      "A JSON file with the field sites, as an earlier answer with --json has it");
  command->add_option("-m,--method", arguments->method, "What distances the diagram is made of (exact)")
      ->check(CLI::IsMember({"exact", "bounded", "edges"}));
  command
      ->add_option("-e,--relative-error", arguments->relative_error, "Allowed error of every distance; bounded (0.01)")
      ->check(CLI::Range(0.0, 1.0));
  command
      ->add_option(
          "--border-deviation", arguments->border_deviation,
          "Largest distance of borders from the lines that draw them, in diagonals of the mesh, from 1e-7 to 1 (1e-5)")
      ->check(CLI::PositiveNumber);
  add_optimization_options(*command, *arguments);
  command->add_option("--obj", arguments->obj_file,
                      "Write borders and cells as OBJ, - for the terminal; each file divides the surface once more");
  command->add_option("--vtu", arguments->vtu_file, "Write cells and borders for ParaView");
  command->add_option("--svg", arguments->svg_file, "Write flat panels with numbered edges, in mm");
  command->add_option("--csv", arguments->csv_file, "Write the panels' lengths and angles");
  command->add_option("--panel-scale", arguments->panel_scale, "Millimetres per mesh unit on the panels (1)")
      ->check(CLI::PositiveNumber);
  command->add_option("--deadline", arguments->deadline, "Seconds that the computation may take, or for example 2min")
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
  command->footer(
      "Examples:\n  supple voronoi bunny.obj v0 v300 v900 --obj cells.obj\n"
      "  supple voronoi bunny.obj --random 200 --seed 3 --relative-error 0.01\n"
      "  supple voronoi bunny.obj --random 200 --optimize centroidal --vtu cells.vtu\n"
      "  supple voronoi shell.obj --random 60 --optimize edge_length=1,planarity=20 --svg panels.svg --csv panels.csv "
      "--panel-scale 250");
  command->callback([&options, arguments, command] {
    check_effects(*command, *arguments);
    run(options, *arguments);
  });
}

}  // namespace supple::cli
