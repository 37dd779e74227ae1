#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "commands.h"
#include "failure.h"
#include "host_arguments.h"
#include "idle_options.h"
#include "numbers.h"
#include "path_output.h"
#include "picture.h"
#include "style.h"
#include "surface_point.h"
#include "units.h"

namespace supple::cli {
namespace {

constexpr const char* networks_path = "/v1/embedded-systems";

struct RelaxArguments {
  std::string mesh;
  std::vector<std::string> points;
  std::string network_file;
  std::string per_face;
  double poisson_disk = 0;
  std::vector<std::string> springs;
  double rest_length = -1;
  double weight = -1;
  std::vector<std::string> triangles;
  double youngs_modulus = 0;
  double poisson_ratio = -2;
  double thickness = 0;
  double rest_scale = 0;
  std::string fixed;
  std::string method;
  double tolerance = 0;
  std::string mollifier;
  double mollifier_length = 0;
  std::string kept_strips;
  double deadline = 0;
  HostArguments host;
  std::string obj_file;
  std::string vtu_file;
  std::string plot_file;
  int seed = -1;
  int max_iterations = 0;
  bool adjacent_faces = false;
  bool voronoi_dual = false;
  bool membrane = false;
  bool euclidean = false;
  bool history = false;
};

/// A spring from "0,1", "0,1,rest_length" or "0,1,rest_length,weight".
nlohmann::json parse_spring(const std::string& text, const RelaxArguments& arguments) {
  const auto numbers = parse_numbers(text, "spring");
  if (numbers.size() < 2 || numbers.size() > 4)
    throw Failure(ExitCode::usage, fmt::format("'{}' is no spring: I,J[,REST_LENGTH[,WEIGHT]]", text));
  nlohmann::json spring = {{"between", {index_of(numbers[0], text, "point"), index_of(numbers[1], text, "point")}}};
  const double rest_length = numbers.size() > 2 ? numbers[2] : arguments.rest_length;
  const double weight = numbers.size() > 3 ? numbers[3] : arguments.weight;
  if (numbers.size() > 2 || rest_length >= 0) spring["rest_length"] = rest_length;
  if (numbers.size() > 3 || weight >= 0) spring["weight"] = weight;
  return spring;
}

void set_points(const RelaxArguments& arguments, nlohmann::json& request) {
  const int sources = static_cast<int>(!arguments.points.empty()) + static_cast<int>(!arguments.per_face.empty()) +
                      static_cast<int>(arguments.poisson_disk > 0) + static_cast<int>(request.contains("points"));
  if (sources != 1)
    throw Failure(ExitCode::usage, "give points, or one of --per-face, --poisson-disk and --network with points");
  if (!arguments.points.empty()) {
    request["points"] = nlohmann::json::array();
    for (const auto& point : arguments.points) request["points"].push_back(parse_surface_point(point));
  } else if (!arguments.per_face.empty()) {
    request["points"] = {{"kind", "per_face"}, {"barycentric", parse_numbers(arguments.per_face, "point of a face")}};
  } else if (arguments.poisson_disk > 0) {
    request["points"] = {{"kind", "poisson_disk"}, {"radius", arguments.poisson_disk}};
    if (arguments.seed >= 0) request["points"]["seed"] = arguments.seed;
  }
}

void set_triangles(const RelaxArguments& arguments, nlohmann::json& request) {
  if (static_cast<int>(!arguments.triangles.empty()) + static_cast<int>(arguments.membrane) +
          static_cast<int>(request.contains("triangles")) >
      1)
    throw Failure(ExitCode::usage, "give triangles by one of --triangle, --membrane and --network with triangles");
  if (arguments.membrane) request["triangles"] = {{"kind", "voronoi_dual"}};
  for (const auto& text : arguments.triangles) {
    auto corners = parse_indices(text, "point");
    if (corners.size() != 3) throw Failure(ExitCode::usage, fmt::format("'{}' is no triangle: I,J,K", text));
    request["triangles"].push_back(corners);
  }
  if (arguments.youngs_modulus > 0) request["membrane"]["youngs_modulus"] = arguments.youngs_modulus;
  if (arguments.poisson_ratio > -1) request["membrane"]["poisson_ratio"] = arguments.poisson_ratio;
  if (arguments.thickness > 0) request["membrane"]["thickness"] = arguments.thickness;
  if (arguments.rest_scale > 0) request["membrane"]["rest_scale"] = arguments.rest_scale;
}

void set_springs(const RelaxArguments& arguments, nlohmann::json& request) {
  const int sources = static_cast<int>(!arguments.springs.empty()) + static_cast<int>(arguments.adjacent_faces) +
                      static_cast<int>(arguments.voronoi_dual) + static_cast<int>(request.contains("springs"));
  if (sources == 0 && request.contains("triangles")) {
    request["springs"] = nlohmann::json::array();
    return;
  }
  if (sources != 1) {
    throw Failure(ExitCode::usage,
                  "give springs by --spring, or one of --adjacent-faces, --voronoi-dual and --network with springs, or "
                  "triangles");
  }
  if (!arguments.springs.empty()) {
    request["springs"] = nlohmann::json::array();
    for (const auto& spring : arguments.springs) request["springs"].push_back(parse_spring(spring, arguments));
  } else if (!request.contains("springs")) {
    request["springs"] = {{"kind", arguments.adjacent_faces ? "adjacent_faces" : "voronoi_dual"}};
    if (arguments.rest_length >= 0) request["springs"]["rest_length"] = arguments.rest_length;
    if (arguments.weight >= 0) request["springs"]["weight"] = arguments.weight;
  }
}

nlohmann::json network_request(const RelaxArguments& arguments) {
  nlohmann::json request = nlohmann::json::object();
  if (!arguments.network_file.empty()) request = object_in_file(arguments.network_file);
  set_points(arguments, request);
  set_triangles(arguments, request);
  set_springs(arguments, request);
  set_host(arguments.host, request);
  if (!arguments.fixed.empty()) request["fixed_points"] = parse_indices(arguments.fixed, "point");
  if (arguments.euclidean) request["spring_length"] = "euclidean";
  if (!arguments.method.empty()) request["method"] = arguments.method;
  if (arguments.tolerance > 0) request["accuracy"]["tolerance"] = arguments.tolerance;
  if (arguments.mollifier_length > 0) request["accuracy"]["mollifier_length"] = arguments.mollifier_length;
  if (arguments.max_iterations > 0) request["max_iterations"] = arguments.max_iterations;
  if (!arguments.mollifier.empty()) request["effects"]["mollifier"] = arguments.mollifier;
  if (!arguments.kept_strips.empty()) request["effects"]["kept_strips"] = arguments.kept_strips;
  if (arguments.deadline > 0) request["deadline"] = arguments.deadline;
  if (!arguments.obj_file.empty()) request["paths"] = true;
  return request;
}

void print_relaxation_history(const nlohmann::json& history) {
  fmt::print("{:>4}  {:>16}  {:>12}  {:>12}  {:>12}\n", "step", "energy", "|gradient|", "moved", "added");
  for (std::size_t i = 0; i < history.size(); ++i) {
    const auto& state = history.at(i);
    fmt::print("{:>4}  {:>16.9g}  {:>12.3e}  {:>12.3e}  {:>12.3g}\n", i, state.at("energy").get<double>(),
               state.at("gradient_norm").get<double>(), state.at("step_length").get<double>(),
               state.at("regularization").get<double>());
  }
}

void print_relaxation(const nlohmann::json& answer, bool history) {
  fmt::print("network     {} points, {} springs", answer.at("points").size(), answer.at("springs").size());
  if (const auto membrane = answer.find("membrane"); membrane != answer.end()) {
    double greatest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& triangle : *membrane) {
      greatest = std::max(greatest, triangle.at("stretches").at(0).get<double>());
      least = std::min(least, triangle.at("stretches").at(1).get<double>());
    }
    fmt::print(", {} triangles stretched {:.4g} to {:.4g} times", membrane->size(), least, greatest);
  }
  fmt::print("\n");
  print_host(answer);
  fmt::print("energy      {:.12g}{}\n", answer.at("energy").get<double>(),
             answer.at("mollified").get<bool>() ? " (mollified)" : "");
  print_terms(answer);
  fmt::print("|gradient|  {:.3e} (asked for {:.3e})\n", answer.at("gradient_norm").get<double>(),
             answer.at("accuracy").at("gradient_tolerance").get<double>());
  fmt::print("stopped     {} after {} iterations, {:.4g} s\n", answer.at("stopped").get<std::string>(),
             answer.at("iterations").get<int>(), answer.at("cost").at("seconds").get<double>());
  for (const auto& warning : answer.at("warnings"))
    fmt::print("{}     {}\n", styled("warning", Style::warning), warning.get<std::string>());
  print_points_in_space(answer);
  if (history) print_relaxation_history(answer.at("history"));
}

void write_spring_paths(const std::string& file, const nlohmann::json& springs) {
  auto paths = nlohmann::json::array();
  for (const auto& spring : springs) paths.push_back(spring.at("path"));
  write_file(file, paths_as_obj(paths));
}

void check_effects(const CLI::App& command, const RelaxArguments& arguments, const nlohmann::json& request) {
  const bool has_membrane = request.contains("triangles");
  const bool makes_springs = !arguments.springs.empty() || arguments.adjacent_faces || arguments.voronoi_dual;
  constexpr const char* no_membrane = "without --membrane, --triangle or triangles in the file of --network";
  constexpr const char* no_springs = "without --spring, --adjacent-faces or --voronoi-dual";
  refuse_idle_options(command, {{"--seed", arguments.poisson_disk > 0, "without --poisson-disk"},
                                {"--rest-length", makes_springs, no_springs},
                                {"--weight", makes_springs, no_springs},
                                {"--youngs-modulus", has_membrane, no_membrane},
                                {"--poisson-ratio", has_membrane, no_membrane},
                                {"--thickness", has_membrane, no_membrane},
                                {"--rest-scale", has_membrane, no_membrane},
                                {"--mollifier-length", arguments.mollifier != "off", "with --mollifier off"}});
}

void run(const CLI::App& command, const GlobalOptions& options, const RelaxArguments& arguments) {
  auto request = network_request(arguments);
  check_effects(command, arguments, request);
  Session session(options);
  request["mesh"] = session.mesh_id(arguments.mesh);
  const nlohmann::json answer = session.compute(networks_path, request).json();
  if (!arguments.obj_file.empty()) {
    // The paths are in the answer. Faces of triangles and of the host are only in the server's file.
    if (answer.contains("membrane") || answer.contains("host")) {
      write_file(arguments.obj_file, session.compute(networks_path, request, "model/obj").body);
    } else {
      write_spring_paths(arguments.obj_file, answer.at("springs"));
    }
  }
  if (!arguments.vtu_file.empty())
    write_file(arguments.vtu_file, session.compute(networks_path, request, "application/x-vtu+xml").body);
  if (!arguments.plot_file.empty())
    write_picture(arguments.plot_file, session.compute(networks_path, request, "image/svg+xml").body);
  if (arguments.obj_file == "-" || arguments.vtu_file == "-" || arguments.plot_file == "-") return;
  session.json() ? print_json(answer) : print_relaxation(answer, arguments.history);
}

void add_network_options(CLI::App& command, RelaxArguments& arguments) {
  command.add_option("mesh", arguments.mesh, "Mesh")->required();
  command.add_option("points", arguments.points, "Where the network's points start, in their order");
  command.add_option(
      "--network", arguments.network_file,
      "A JSON file with what a request has: points, springs, fixed_points, host (moving ones too) and options");
  command.add_option("--per-face", arguments.per_face, "A point in each face, at these barycentric coordinates: a,b,c");
  command
      .add_option("--poisson-disk", arguments.poisson_disk,
                  "Random points no nearer to each other than this geodesic distance, in mesh units")
      ->check(CLI::PositiveNumber);
  command.add_option("--seed", arguments.seed, "Of the random points (1)")->check(CLI::NonNegativeNumber);
  command.add_option("-s,--spring", arguments.springs, "A spring I,J[,REST_LENGTH[,WEIGHT]]; may be repeated")
      ->allow_extra_args(false);
  command.add_flag("--adjacent-faces", arguments.adjacent_faces, "Springs between points whose faces share an edge");
  command.add_flag("--voronoi-dual", arguments.voronoi_dual, "Springs between points whose Voronoi cells meet");
  command.add_option("--rest-length", arguments.rest_length, "Of springs that say none, in mesh units (0)")
      ->check(CLI::NonNegativeNumber);
  command.add_option("--weight", arguments.weight, "Of springs that say none: energy per squared mesh unit (1)")
      ->check(CLI::NonNegativeNumber);
  command.add_option("--triangle", arguments.triangles, "A triangle I,J,K of a membrane; may be repeated")
      ->allow_extra_args(false);
  command.add_flag("--membrane", arguments.membrane, "Triangles of points whose Voronoi cells meet, all of a membrane");
  command.add_option("--youngs-modulus", arguments.youngs_modulus, "Of the membrane: energy per cubed mesh unit (1)")
      ->check(CLI::PositiveNumber);
  command.add_option("--poisson-ratio", arguments.poisson_ratio, "Of the membrane (0.3)")
      ->check(CLI::Range(-0.99, 0.4999));
  command.add_option("--thickness", arguments.thickness, "Of the membrane, in mesh units (1)")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--rest-scale", arguments.rest_scale,
                  "Of the membrane: its lengths at rest over those at the start; below 1 it is stretched (1)")
      ->check(CLI::PositiveNumber);
  command.add_option("-f,--fixed", arguments.fixed, "Points that stay where they are: indices separated by commas");
}

void add_relaxation_options(CLI::App& command, RelaxArguments& arguments) {
  command.add_flag("--euclidean", arguments.euclidean, "Measure springs through space instead of on the surface");
  command.add_option("-m,--method", arguments.method, "How to minimize (newton)")
      ->check(CLI::IsMember({"newton", "lbfgs", "gradient_descent"}));
  command
      .add_option("-t,--tolerance", arguments.tolerance,
                  "Stop once |gradient| <= tolerance * largest weight * diagonal of the bounding box (1e-9)")
      ->check(CLI::PositiveNumber);
  command.add_option("--max-iterations", arguments.max_iterations, "Give up after so many (200)")
      ->check(CLI::PositiveNumber);
  command.add_option("--mollifier", arguments.mollifier, "Smooth paths next to vertices (automatic)")
      ->check(CLI::IsMember({"automatic", "on", "off"}));
  command.add_option("--mollifier-length", arguments.mollifier_length, "As a fraction of an edge (1e-6)")
      ->check(CLI::PositiveNumber);
  command.add_option("--kept-strips", arguments.kept_strips, "Unfold the faces of earlier paths first (automatic)")
      ->check(CLI::IsMember({"automatic", "on", "off"}));
  command.add_option("--deadline", arguments.deadline, "Seconds that the computation may take, or for example 2min")
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
}

}  // namespace

void add_relax_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<RelaxArguments>();
  CLI::App* command =
      program.add_subcommand("relax", "The equilibrium of an elastic network whose points slide on the surface");
  add_network_options(*command, *arguments);
  add_host_options(*command, arguments->host);
  add_relaxation_options(*command, *arguments);
  command->add_flag("--history", arguments->history, "Show every iteration");
  command->add_option(
      "--obj", arguments->obj_file,
      "Write the springs' paths as OBJ polylines, triangles and a host that gives way as faces (computes "
      "it once more), - for the terminal");
  command->add_option("--vtu", arguments->vtu_file,
                      "Write the network and a host that gives way for ParaView; computes it once more");
  command
      ->add_option("--plot", arguments->plot_file,
                   "Draw the convergence as SVG or PNG, - for the terminal (SVG); computes it once more")
      ->check(plot_file());
  command->footer(
      "Examples:\n  supple relax bunny.obj v0 v300 v900 --spring 0,1 --spring 1,2 --fixed 0,2 --history\n"
      "  supple relax bunny.obj --poisson-disk 0.2 --voronoi-dual --rest-length 0.15 --obj network.obj\n"
      "  supple relax bunny.obj --per-face 0.3,0.3,0.4 --adjacent-faces --fixed 0,17 --plot convergence.svg\n"
      "  supple relax bunny.obj --poisson-disk 0.2 --membrane --rest-scale 0.9 --vtu membrane.vtu\n"
      "  supple relax bunny.obj --poisson-disk 0.2 --voronoi-dual --host-kind solid --host-youngs-modulus 50 --obj "
      "soft.obj\n"
      "  supple relax bunny.obj v0 v300 --spring 0,1 --fixed 0 --host-kind shell --host-thickness 0.01 "
      "--host-youngs-modulus 1e4 --fix-vertex 0,1,2 --move-vertex 900,0,0.2,1\n"
      "  supple relax step0.obj v0 v300 --spring 0,1 --fixed 0 --host-kind moving --positions step1.obj --positions "
      "step2.obj");
  command->callback([&options, arguments, command] { run(*command, options, *arguments); });
}

}  // namespace supple::cli
