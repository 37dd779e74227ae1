#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <vector>

#include "commands.h"
#include "failure.h"
#include "path_output.h"
#include "surface_point.h"
#include "table_numbers.h"

namespace supple::cli {
namespace {

struct GeodesicArguments {
  std::string mesh;
  std::vector<std::string> points;
  int derivatives = 0;
  std::string path_file;
};

void print_vector(const char* name, const nlohmann::json& values) {
  fmt::print("  {:<10}", name);
  for (const auto& value : values) fmt::print(" {:>12}", rounded(value, scale_of(values), 6));
  fmt::print("\n");
}

void print_result(const nlohmann::json& pair, const nlohmann::json& result) {
  fmt::print("{} -> {}: ", describe_surface_point(pair.at("from")), describe_surface_point(pair.at("to")));
  if (result.at("unreachable").get<bool>()) {
    fmt::print("unreachable (different components)\n");
    return;
  }
  fmt::print("distance {}\n", precise(result.at("distance").get<double>()));
  if (!result.value("unique", true)) {
    fmt::print("  not unique: another path is as short\n");
  } else if (result.value("near_cut_locus", false)) {
    fmt::print("  near the cut locus: another path is longer by {:.3g} only\n", result.value("competing_excess", 0.0));
  }
  const auto pinned = result.value("pinned_at", std::vector<std::int64_t>());
  if (!pinned.empty()) fmt::print("  bends at vertex {}\n", fmt::join(pinned, ", "));
  if (!result.value("differentiable", true)) fmt::print("  the ends coincide: no derivatives\n");
  if (result.contains("gradient")) print_vector("gradient", result.at("gradient").at("tangent"));
  if (result.contains("hessian")) {
    for (const auto& row : result.at("hessian").at("tangent")) print_vector("Hessian", row);
  }
}

void write_paths(const std::string& file, const nlohmann::json& results) {
  auto paths = nlohmann::json::array();
  for (const auto& result : results) paths.push_back(result.value("path", nlohmann::json::array()));
  write_file(file, file.ends_with(".json") ? paths.dump() + "\n" : paths_as_obj(paths));
}

void run(const GlobalOptions& options, const GeodesicArguments& arguments) {
  if (arguments.points.size() % 2 != 0) {
    throw Failure(ExitCode::usage, fmt::format("{} points are no pairs: give a start and an end for each geodesic",
                                               arguments.points.size()));
  }
  auto pairs = nlohmann::json::array();
  for (std::size_t i = 0; i < arguments.points.size(); i += 2) {
    pairs.push_back(
        {{"from", parse_surface_point(arguments.points[i])}, {"to", parse_surface_point(arguments.points[i + 1])}});
  }
  Session session(options);
  const nlohmann::json request = {{"mesh", session.mesh_id(arguments.mesh)},
                                  {"pairs", pairs},
                                  {"derivatives", arguments.derivatives},
                                  {"paths", !arguments.path_file.empty()}};
  const nlohmann::json answer = session.compute("/v1/geodesics", request).json();
  const auto& results = answer.at("results");
  if (!arguments.path_file.empty()) write_paths(arguments.path_file, results);
  if (arguments.path_file == "-") return;
  if (session.json()) return print_json(answer);
  for (std::size_t i = 0; i < pairs.size(); ++i) print_result(pairs.at(i), results.at(i));
  print_points_in_space(answer);
}

}  // namespace

void add_geodesic_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<GeodesicArguments>();
  CLI::App* command = program.add_subcommand("geodesic", "Exact shortest distances and paths between pairs of points");
  command->add_option("mesh", arguments->mesh, "Mesh")->required();
  command->add_option("points", arguments->points, "Start and end of each geodesic, in turn")->required();
  command
      ->add_option(
          "-d,--derivatives", arguments->derivatives,
          "1 for gradients, 2 for Hessians too, with respect to displacements of both ends in their faces' frames")
      ->check(CLI::Range(0, 2));
  command->add_option(
      "-p,--path", arguments->path_file,
      "Write the paths to this file: .json as JSON, anything else as OBJ polylines, - for the terminal");
  command->footer(
      "Examples:\n  supple geodesic bunny.obj v0 v1200\n  supple geodesic bunny.obj v0 12:0.2,0.3,0.5 --path path.obj\n"
      "  supple geodesic bunny.obj v0 v10 v0 v11 --derivatives 2 --json");
  command->callback([&options, arguments] { run(options, *arguments); });
}

}  // namespace supple::cli
