#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <vector>

#include "commands.h"
#include "failure.h"
#include "idle_options.h"
#include "numbers.h"
#include "table_numbers.h"
#include "units.h"

namespace supple::cli {
namespace {

struct StructureArguments {
  std::string family;
  std::string parameters;
  std::string cells;
  double height = 0;
  double beam_width = 0;
  double mesh_size = 0;
  double corner_size = 0;
  std::string mesh_region;
  std::string svg_file;
  std::string dxf_file;
  std::string stl_file;
};

nlohmann::json parse_cells(const std::string& text) {
  const std::string_view all = text;
  const std::size_t cross = all.find('x');
  const auto first = integer_in(all.substr(0, cross)).value_or(0);
  const auto second = cross == std::string::npos ? 0 : integer_in(all.substr(cross + 1)).value_or(0);
  if (first < 1 || second < 1) {
    throw Failure(ExitCode::usage, fmt::format("'{}' is no number of cells: write for example 4x3", text));
  }
  return {first, second};
}

void print_structure(const nlohmann::json& answer) {
  const auto& lattice = answer.at("lattice");
  std::size_t holes = 0;
  for (const auto& tile : answer.at("tiles")) holes += tile.at("holes").size();
  fmt::print("structure   {} ({:g})\n", answer.at("family").get<std::string>(),
             fmt::join(answer.at("parameters").get<std::vector<double>>(), ","));
  fmt::print("beam width  {:g} mm\n", answer.at("beam_width").get<double>());
  fmt::print("cell        {:.6g} mm^2, {} tiles, {} holes\n", answer.at("cell_area").get<double>(),
             answer.at("tiles").size(), holes);
  for (const auto& translation : lattice) {
    fmt::print("translation {} {} mm\n", rounded(translation.at(0), scale_of(lattice), 6),
               rounded(translation.at(1), scale_of(lattice), 6));
  }
  fmt::print("solid       {:.6g} of the cell\n", answer.at("relative_density").get<double>());
  if (const auto mesh = answer.find("mesh"); mesh != answer.end()) {
    fmt::print("mesh        {} nodes, {} triangles, sides {:.4g} to {:.4g} mm, smallest angle {:.3g} rad\n",
               mesh->at("nodes").get<int>(), mesh->at("triangles").get<int>(), mesh->at("shortest_side").get<double>(),
               mesh->at("longest_side").get<double>(), mesh->at("smallest_angle").get<double>());
  }
}

void check_effects(const CLI::App& command, const StructureArguments& arguments) {
  const bool has_file = !arguments.svg_file.empty() || !arguments.dxf_file.empty() || !arguments.stl_file.empty();
  const bool is_described = arguments.svg_file != "-" && arguments.dxf_file != "-" && arguments.stl_file != "-";
  constexpr const char* not_described = "where a file goes to the terminal in place of the mesh's statistics";
  refuse_idle_options(command, {{"--cells", has_file, "without --svg, --dxf or --stl"},
                                {"--height", !arguments.stl_file.empty(), "without --stl"},
                                {"--mesh-size", is_described, not_described},
                                {"--corner-size", is_described, not_described},
                                {"--mesh-region", is_described, not_described}});
}

void run(const GlobalOptions& options, const StructureArguments& arguments) {
  nlohmann::json request = {{"family", arguments.family}};
  if (!arguments.parameters.empty()) request["parameters"] = parse_numbers(arguments.parameters, "list of parameters");
  if (!arguments.cells.empty()) request["cells"] = parse_cells(arguments.cells);
  if (arguments.beam_width > 0) request["beam_width"] = arguments.beam_width;
  if (arguments.height > 0) request["height"] = arguments.height;
  Session session(options);
  const auto save = [&](const std::string& file, const char* media_type) {
    if (!file.empty()) write_file(file, session.compute("/v1/structures", request, media_type).body);
  };
  save(arguments.svg_file, "image/svg+xml");
  save(arguments.dxf_file, "image/vnd.dxf");
  save(arguments.stl_file, "model/stl");
  if (arguments.svg_file == "-" || arguments.dxf_file == "-" || arguments.stl_file == "-") return;
  if (arguments.mesh_size > 0) request["mesh"]["mesh_size"] = arguments.mesh_size;
  if (arguments.corner_size > 0) request["mesh"]["corner_size"] = arguments.corner_size;
  if (!arguments.mesh_region.empty()) request["mesh"]["mesh_region"] = arguments.mesh_region;
  const nlohmann::json answer = session.compute("/v1/structures", request).json();
  session.json() ? print_json(answer) : print_structure(answer);
}

}  // namespace

void add_structure_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<StructureArguments>();
  CLI::App* command = program.add_subcommand("structure", "The beam structure of a tiling, and files of it");
  command->add_option("family", arguments->family, "Family of the tiling, see supple families")->required();
  command->add_option("-p,--parameters", arguments->parameters,
                      "Parameters, separated by commas (the family's defaults)");
  command->add_option("--svg", arguments->svg_file, "Write an SVG file, - for the terminal");
  command->add_option("--dxf", arguments->dxf_file, "Write a DXF file, - for the terminal");
  command->add_option("--stl", arguments->stl_file, "Write a binary STL file of the extruded solid");
  command->add_option("-c,--cells", arguments->cells, "Cells in the files, for example 4x3 (2x2)");
  command->add_option("--beam-width", arguments->beam_width, "Width of the beams in mm (0.3)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber);
  command->add_option("--height", arguments->height, "Height of the STL's extrusion in mm (1)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--mesh-size", arguments->mesh_size,
                   "Mesh one cell with sides of this share of the beam width and show the mesh's statistics")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--corner-size", arguments->corner_size, "Sides at re-entrant corners as a share of the others (1)")
      ->check(CLI::PositiveNumber);
  command->add_option("--mesh-region", arguments->mesh_region, "What is meshed at a time (automatic)")
      ->check(CLI::IsMember({"automatic", "tile", "cell"}));
  command->footer(
      "Examples:\n  supple structure IH21 --svg tiling.svg --cells 4x4\n"
      "  supple structure IH01 --parameters 0.1,0.5,0.1,0.6 --stl tiling.stl --height 5 --mesh-size 0.33");
  command->callback([&options, arguments, command] {
    check_effects(*command, *arguments);
    run(options, *arguments);
  });
}

}  // namespace supple::cli
