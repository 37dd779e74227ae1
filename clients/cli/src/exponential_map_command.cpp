#include <fmt/format.h>

#include <memory>

#include "commands.h"
#include "numbers.h"
#include "path_output.h"
#include "surface_point.h"
#include "table_numbers.h"

namespace supple::cli {
namespace {

struct ExponentialMapArguments {
  std::string mesh;
  std::string start;
  std::string tangent;
  std::string path_file;
};

void print_exponential_map(const nlohmann::json& answer) {
  const auto& position = answer.at("position");
  fmt::print("end         {}\n", describe_surface_point(answer.at("end")));
  const double scale = scale_of(position);
  fmt::print("position    {} {} {}\n", rounded(position.at(0), scale, 15), rounded(position.at(1), scale, 15),
             rounded(position.at(2), scale, 15));
  fmt::print("length      {:.12g}{}\n", answer.at("length").get<double>(),
             answer.at("reached_boundary").get<bool>() ? ", stopped at the boundary" : "");
  fmt::print("transport   {:.9g} rad\n", answer.at("transport_angle").get<double>());
  print_points_in_space(answer);
}

void run(const GlobalOptions& options, const ExponentialMapArguments& arguments) {
  nlohmann::json request = {{"start", parse_surface_point(arguments.start)},
                            {"tangent", parse_numbers(arguments.tangent, "tangent vector")},
                            {"trace", !arguments.path_file.empty()}};
  Session session(options);
  request["mesh"] = session.mesh_id(arguments.mesh);
  const nlohmann::json answer = session.compute("/v1/exponential-maps", request).json();
  if (!arguments.path_file.empty()) {
    const auto& trace = answer.at("trace");
    write_file(arguments.path_file, arguments.path_file.ends_with(".json")
                                        ? trace.dump() + "\n"
                                        : paths_as_obj(nlohmann::json::array({trace})));
  }
  if (arguments.path_file == "-") return;
  session.json() ? print_json(answer) : print_exponential_map(answer);
}

}  // namespace

void add_exponential_map_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<ExponentialMapArguments>();
  CLI::App* command =
      program.add_subcommand("exponential-map", "Where the straightest path of a given direction and length ends");
  command->add_option("mesh", arguments->mesh, "Mesh")->required();
  command->add_option("start", arguments->start, "Where the path starts")->required();
  command
      ->add_option("-t,--tangent", arguments->tangent,
                   "x,y,z in space (its part within the start's face counts), or two coordinates in that face's frame")
      ->required();
  command->add_option(
      "-p,--path", arguments->path_file,
      "Write the trace to this file: .json as JSON, anything else as an OBJ polyline, - for the terminal");
  command->footer("Example:\n  supple exponential-map bunny.obj v0 --tangent 0.1,0,0.2 --path trace.obj");
  command->callback([&options, arguments] { run(options, *arguments); });
}

}  // namespace supple::cli
