#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "commands.h"
#include "field_output.h"
#include "idle_options.h"
#include "surface_point.h"
#include "table_numbers.h"

namespace supple::cli {
namespace {

constexpr int default_bands = 20;

struct FieldArguments {
  std::string mesh;
  std::vector<std::string> sources;
  std::string output;
  double relative_error = 0;
  double max_distance = 0;
  std::string method;
  int bands = default_bands;
};

void print_summary(const std::vector<double>& distances) {
  double largest = 0;
  double sum = 0;
  std::size_t reached = 0;
  for (const double d : distances) {
    if (!std::isfinite(d)) continue;
    largest = std::max(largest, d);
    sum += d;
    ++reached;
  }
  fmt::print("vertices    {}\n", distances.size());
  fmt::print("unreached   {}\n", distances.size() - reached);
  fmt::print("largest     {}\n", precise(largest));
  fmt::print("mean        {}\n", precise(reached > 0 ? sum / static_cast<double>(reached) : 0.0));
}

void run(const GlobalOptions& options, const FieldArguments& arguments) {
  nlohmann::json request = {{"sources", nlohmann::json::array()}};
  for (const auto& source : arguments.sources) request["sources"].push_back(parse_surface_point(source));
  if (arguments.relative_error > 0) request["accuracy"]["relative_error"] = arguments.relative_error;
  if (!arguments.method.empty()) request["accuracy"]["method"] = arguments.method;
  if (arguments.max_distance > 0) request["max_distance"] = arguments.max_distance;
  Session session(options);
  const std::string mesh = session.mesh_id(arguments.mesh);
  request["mesh"] = mesh;
  if (session.json() && arguments.output.empty())
    return print_json(session.compute("/v1/geodesic-fields", request).json());

  const Answer answer = session.compute("/v1/geodesic-fields", request, "application/octet-stream");
  const std::vector<double> distances = decode_field(answer.body);
  if (arguments.output.ends_with(".ply")) {
    const Geometry geometry = decode_geometry(session.http().get("/v1/meshes/" + mesh + "/content", "model/ply").body);
    write_file(arguments.output, field_as_ply(geometry, distances, arguments.bands));
  } else if (arguments.output.ends_with(".f64")) {
    write_file(arguments.output, answer.body);
  } else if (!arguments.output.empty()) {
    write_file(arguments.output, field_as_csv(distances));
  }
  if (arguments.output == "-" || session.json()) return;
  print_summary(distances);
  if (!answer.largest_distance.empty())
    fmt::print("in space    sources lie up to {} from the surface\n", answer.largest_distance);
}

}  // namespace

void add_field_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<FieldArguments>();
  CLI::App* command = program.add_subcommand("field", "Geodesic distance from one or several sources to every vertex");
  command->add_option("mesh", arguments->mesh, "Mesh")->required();
  command->add_option("sources", arguments->sources, "The distance is to the nearest of these points")->required();
  command->add_option(
      "-o,--output", arguments->output,
      "Write the field to this file: .ply coloured, .f64 raw little-endian doubles (-1 where unreached), "
      "anything else CSV, - for CSV on the terminal");
  command->add_option("-e,--relative-error", arguments->relative_error, "Allowed relative error; 0 is exact")
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--max-distance", arguments->max_distance, "Stop beyond this distance")
      ->check(CLI::PositiveNumber);
  command->add_option("-m,--method", arguments->method, "windows (exact or bounded error) or edge_graph (upper bound)")
      ->check(CLI::IsMember({"windows", "edge_graph"}));
  command->add_option("--bands", arguments->bands, "Level bands in the colours of a .ply; 0 for none")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->footer(
      "Examples:\n  supple field bunny.obj v0 --output distances.ply\n"
      "  supple field bunny.obj v0 v700 --relative-error 0.01 --output - | sort -t, -k2 -g | tail");
  command->callback([&options, arguments, command] {
    refuse_idle_options(*command, {{"--bands", arguments->output.ends_with(".ply"), "without --output FILE.ply"}});
    run(options, *arguments);
  });
}

}  // namespace supple::cli
