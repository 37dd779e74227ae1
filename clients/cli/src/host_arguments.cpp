#include "host_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "failure.h"
#include "numbers.h"
#include "session.h"

namespace supple::cli {
namespace {

struct HostOption {
  const char* name;
  const char* kind;  ///< shell, solid or moving; nullptr: shell and solid
  bool given;
};

std::array<HostOption, 12> host_options(const HostArguments& arguments) {
  return {{{"--host-youngs-modulus", nullptr, arguments.youngs_modulus > 0},
           {"--host-poisson-ratio", nullptr, arguments.poisson_ratio > -1},
           {"--fix-vertex", nullptr, !arguments.fixed_vertices.empty()},
           {"--move-vertex", nullptr, !arguments.moved_vertices.empty()},
           {"--positions", "moving", !arguments.positions.empty()},
           {"--host-thickness", "shell", arguments.thickness > 0},
           {"--volume-weight", "shell", arguments.volume_weight >= 0},
           {"--volume-scale", "shell", arguments.volume_scale > 0},
           {"--no-bending", "shell", arguments.no_bending},
           {"--element-size", "solid", arguments.element_size > 0},
           {"--region", "solid", !arguments.regions.empty()},
           {"--gravity", "solid", !arguments.gravity.empty()}}};
}

void check_kind(const HostArguments& arguments, const std::string& kind) {
  for (const auto& option : host_options(arguments)) {
    const bool fits = option.kind == nullptr ? kind == "shell" || kind == "solid" : option.kind == kind;
    if (!option.given || fits) continue;
    throw Failure(ExitCode::usage, fmt::format("{} needs --host-kind {}", option.name,
                                               option.kind != nullptr ? option.kind : "shell or --host-kind solid"));
  }
}

nlohmann::json stiffened_region(const std::string& text) {
  const auto numbers = parse_numbers(text, "region");
  if (numbers.size() != 7) throw Failure(ExitCode::usage, fmt::format("'{}' is no region: X0,Y0,Z0,X1,Y1,Z1,E", text));
  return {{"lower", {numbers[0], numbers[1], numbers[2]}},
          {"upper", {numbers[3], numbers[4], numbers[5]}},
          {"youngs_modulus", numbers[6]}};
}

std::int64_t vertex_index(double number, const std::string& text) {
  if (number < 0 || number != std::floor(number) || number > 2147483647.0)
    throw Failure(ExitCode::usage, fmt::format("'{}' names no vertex by its index", text));
  return static_cast<std::int64_t>(number);
}

nlohmann::json vertices_of(const std::vector<std::string>& texts) {
  nlohmann::json vertices = nlohmann::json::array();
  for (const auto& text : texts) {
    for (const double number : parse_numbers(text, "list of vertices")) {
      vertices.push_back(vertex_index(number, text));
    }
  }
  return vertices;
}

nlohmann::json move_of(const std::string& text) {
  const auto numbers = parse_numbers(text, "vertex that is moved");
  if (numbers.size() < 4 || numbers.size() % 3 != 1)
    throw Failure(ExitCode::usage, fmt::format("'{}' moves no vertex: I,X,Y,Z[,X,Y,Z...]", text));
  nlohmann::json positions = nlohmann::json::array();
  for (std::size_t k = 1; k < numbers.size(); k += 3) positions.push_back({numbers[k], numbers[k + 1], numbers[k + 2]});
  return {{"vertex", vertex_index(numbers[0], text)}, {"positions", std::move(positions)}};
}

/// The vertices of an OBJ file, or the rows of a text file, of three numbers each.
nlohmann::json positions_in(const std::string& file) {
  std::istringstream lines(read_file(file));
  nlohmann::json positions = nlohmann::json::array();
  const bool is_obj = file.size() > 4 && file.compare(file.size() - 4, 4, ".obj") == 0;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line);
    std::string first;
    words >> first;
    if (first.empty() || first[0] == '#' || (is_obj && first != "v")) continue;
    if (!is_obj) {
      std::replace(line.begin(), line.end(), ',', ' ');
      words.clear();
      words.str(line);
    }
    std::array<double, 3> place{};
    if (!(words >> place[0] >> place[1] >> place[2]))
      throw Failure(ExitCode::usage, fmt::format("line {} of {} is no position of a vertex: X Y Z", number, file));
    positions.push_back(place);
  }
  return positions;
}

void check_complete(const nlohmann::json& host, const std::string& kind) {
  if ((kind == "shell" || kind == "solid") && !host.contains("youngs_modulus"))
    throw Failure(ExitCode::usage, fmt::format("a {} needs --host-youngs-modulus", kind));
  if (kind == "shell" && !host.contains("thickness")) throw Failure(ExitCode::usage, "a shell needs --host-thickness");
  if (kind == "moving" && !host.contains("positions"))
    throw Failure(ExitCode::usage, "a moving surface needs --positions");
}

bool has_term(const nlohmann::json& answer, const char* name) {
  const auto& terms = answer.at("terms");
  return std::any_of(terms.begin(), terms.end(), [&](const auto& term) { return term.at("name") == name; });
}

}  // namespace

void add_host_options(CLI::App& command, HostArguments& arguments) {
  command
      .add_option("--host-kind", arguments.kind,
                  "What carries the network: a thin shell or the surface of a solid, which give way under it, or a "
                  "surface that is moving as --positions say (rigid)")
      ->check(CLI::IsMember({"rigid", "shell", "solid", "moving"}));
  command.add_option("--host-thickness", arguments.thickness, "Of a shell, in mesh units")->check(CLI::PositiveNumber);
  command
      .add_option("--host-youngs-modulus", arguments.youngs_modulus,
                  "Of a shell or a solid: energy per cubed mesh unit")
      ->check(CLI::PositiveNumber);
  command.add_option("--host-poisson-ratio", arguments.poisson_ratio, "Of a shell or a solid (0.3)")
      ->check(CLI::Range(-0.99, 0.4999));
  command
      .add_option("--volume-weight", arguments.volume_weight,
                  "How strongly a closed shell keeps its volume: energy per cubed mesh unit (0)")
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--volume-scale", arguments.volume_scale,
                  "Of a shell: the volume to keep over that of the mesh; above 1 it is blown up (1)")
      ->check(CLI::PositiveNumber);
  command.add_flag("--no-bending", arguments.no_bending, "The edges of a shell do not resist bending");
  command
      .add_option("--element-size", arguments.element_size,
                  "Of a solid: wanted length of edges inside, in mesh units (mean edge of the mesh)")
      ->check(CLI::PositiveNumber);
  command
      .add_option(
          "--region", arguments.regions,
          "A box X0,Y0,Z0,X1,Y1,Z1,E of a solid with another Young's modulus: corners in mesh units, E in energy "
          "per cubed mesh unit; may be repeated, the last counts")
      ->allow_extra_args(false);
  command.add_option("--gravity", arguments.gravity,
                     "Of a solid: force per volume x,y,z, in energy per mesh unit to the fourth");
  command
      .add_option(
          "--fix-vertex", arguments.fixed_vertices,
          "Vertices of a shell or a solid that stay where they are: indices separated by commas; may be repeated")
      ->allow_extra_args(false);
  command
      .add_option(
          "--move-vertex", arguments.moved_vertices,
          "A vertex I,X,Y,Z[,X,Y,Z...] of a shell or a solid that is taken to these places, in mesh units, once "
          "all is at rest; the rest follows; may be repeated")
      ->allow_extra_args(false);
  command
      .add_option(
          "--positions", arguments.positions,
          "Where all vertices of a moving surface go: an OBJ file of the same mesh, or text with a row X Y Z for "
          "each vertex; may be repeated, one after the other")
      ->allow_extra_args(false);
}

void set_host(const HostArguments& arguments, nlohmann::json& request) {
  const auto given = request.find("host");
  const bool in_file = given != request.end() && given->is_object() && given->contains("kind");
  if (in_file && !given->at("kind").is_string()) return;  // the server refuses it
  const std::string file_kind = in_file ? given->at("kind").get<std::string>() : "rigid";
  const std::string kind = arguments.kind.empty() ? file_kind : arguments.kind;
  check_kind(arguments, kind);
  if (arguments.kind.empty() && !in_file) return;
  auto& host = request["host"];
  if (!in_file || kind != file_kind) host = {{"kind", kind}};
  if (arguments.thickness > 0) host["thickness"] = arguments.thickness;
  if (arguments.youngs_modulus > 0) host["youngs_modulus"] = arguments.youngs_modulus;
  if (arguments.poisson_ratio > -1) host["poisson_ratio"] = arguments.poisson_ratio;
  if (arguments.volume_weight >= 0) host["volume_weight"] = arguments.volume_weight;
  if (arguments.volume_scale > 0) host["volume_scale"] = arguments.volume_scale;
  if (arguments.element_size > 0) host["element_size"] = arguments.element_size;
  if (!arguments.gravity.empty()) {
    host["gravity"] = parse_numbers(arguments.gravity, "force");
    if (host["gravity"].size() != 3)
      throw Failure(ExitCode::usage, fmt::format("'{}' is no force: X,Y,Z", arguments.gravity));
  }
  if (!arguments.regions.empty()) host["regions"] = nlohmann::json::array();
  for (const auto& region : arguments.regions) host["regions"].push_back(stiffened_region(region));
  if (!arguments.fixed_vertices.empty()) host["fixed_vertices"] = vertices_of(arguments.fixed_vertices);
  if (!arguments.moved_vertices.empty()) host["moved_vertices"] = nlohmann::json::array();
  for (const auto& move : arguments.moved_vertices) host["moved_vertices"].push_back(move_of(move));
  if (!arguments.positions.empty()) host["positions"] = nlohmann::json::array();
  for (const auto& file : arguments.positions) host["positions"].push_back(positions_in(file));
  if (arguments.no_bending) request["effects"]["bending"] = "off";
  check_complete(host, kind);
}

void print_host(const nlohmann::json& answer) {
  const auto host = answer.find("host");
  if (host == answer.end()) return;
  fmt::print("host        ");
  if (host->contains("tetrahedra")) {
    fmt::print("solid of {} tetrahedra and {} nodes", host->at("tetrahedra").get<std::int64_t>(),
               host->at("nodes").get<std::int64_t>());
  } else if (has_term(answer, "shell_membrane")) {
    fmt::print("shell of {} vertices", host->at("vertices").size());
  } else {
    fmt::print("moving surface of {} vertices", host->at("vertices").size());
  }
  if (const auto stops = host->find("stops"); stops != host->end()) {
    int jumps = 0;
    for (const auto& stop : *stops) jumps += stop.at("jumps").get<int>();
    fmt::print(", {} positions", stops->size());
    if (jumps > 0) fmt::print(" ({} equilibria lost)", jumps);
  }
  fmt::print(", moved by up to {:.6g}", host->at("largest_displacement").get<double>());
  if (const auto ratio = host->find("volume_ratio"); ratio != host->end())
    fmt::print(", encloses {:.6g} of its volume at rest", ratio->get<double>());
  fmt::print("\n");
}

void print_terms(const nlohmann::json& answer) {
  const auto& terms = answer.at("terms");
  if (terms.size() < 2) return;
  for (const auto& term : terms)
    fmt::print("  {:<18}{:.12g}\n", term.at("name").get<std::string>(), term.at("energy").get<double>());
}

}  // namespace supple::cli
