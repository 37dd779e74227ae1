#include <memory>

#include "commands.h"
#include "part_arguments.h"
#include "part_request.h"
#include "part_simulate_command.h"
#include "session.h"

namespace supple::cli {
namespace {

void run(const CLI::App& command, const GlobalOptions& options, const PartArguments& arguments,
         const PartFiles& files) {
  Session session(options);
  const nlohmann::json request = part_request(command, arguments, session);
  if (write_part(session, request, files)) return;
  const nlohmann::json answer = session.compute("/v1/parts", request).json();
  session.json() ? print_json(answer) : print_part(request, answer);
}

void add_file_options(CLI::App& command, PartFiles& files) {
  command.add_option("--step", files.step, "Write a STEP file, - for the terminal");
  command.add_option("--stl", files.stl, "Write a binary STL file, - for the terminal");
  command.add_option("--3mf", files.three_mf, "Write a 3MF file, - for the terminal");
  command.add_option("--dxf", files.dxf, "Write a DXF file, - for the terminal");
  command.add_option("--svg", files.svg, "Write an SVG file, - for the terminal");
}

}  // namespace

void add_part_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<PartArguments>();
  const auto files = std::make_shared<PartFiles>();
  CLI::App* command =
      program.add_subcommand("part", "A coupon, a block or any outline filled with a structure, as files");
  command->require_subcommand(0, 1);
  add_part_options(*command, *arguments);
  add_file_options(*command, *files);
  command->footer(
      "Examples:\n  supple part IH21 --coupon 20x60 --beam-width 0.8 --thickness 4 --stl coupon.stl\n"
      "  supple part IH22 --outline sole.svg --region heel=IH29,0.5 --region forefoot=IH21,0.5,0.5rad --stl sole.stl\n"
      "  supple part --request sole.json --3mf sole.3mf\n"
      "  supple part --from design.json --coupon 20x60 --stl coupon.stl\n"
      "  supple part simulate IH21 --block 30x20 --strain -20% --csv force.csv");
  command->callback([&options, command, arguments, files] {
    if (command->get_subcommands().empty()) run(*command, options, *arguments, *files);  // else that one has run
  });
  add_part_simulate_command(*command, options, arguments);
}

}  // namespace supple::cli
