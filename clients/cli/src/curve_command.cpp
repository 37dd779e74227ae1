#include <fmt/format.h>

#include <memory>

#include "commands.h"
#include "measured_curve_arguments.h"

namespace supple::cli {
namespace {

struct CurveArguments {
  std::string file;
  std::string task;
  std::string out_file;
  MeasuredCurveArguments measured;
};

/// Lines of control points for --target-points. --target can read them as a measured curve, since the titles have
/// units.
std::string as_lines(const nlohmann::json& answer) {
  const auto task = answer.at("task").get<std::string>();
  std::string lines = task == "stress_strain" ? "strain [1],stress [MPa]\n"
                      : task == "stiffness"   ? "direction [rad],stiffness [MPa]\n"
                                              : "direction [rad],Poisson's ratio [1]\n";
  for (const auto& point : answer.at("target").at("control_points"))
    lines += fmt::format("{},{}\n", point.at(0).get<double>(), point.at(1).get<double>());
  return lines;
}

void run(const GlobalOptions& options, const CurveArguments& arguments) {
  Session session(options);
  const auto answer = reduce_curve(session, bytes_of_measurements(arguments.file), arguments.task, arguments.measured);
  if (!arguments.out_file.empty()) write_file(arguments.out_file, as_lines(answer));
  if (session.json() && arguments.out_file != "-") return print_json(answer);
  print_curve_notes(answer);
  if (arguments.out_file == "-") return;
  const auto& measured_in = answer.at("units");
  fmt::print("{}\n", reduction_words(answer));
  fmt::print("x in {}, y in {}\n", measured_in.at("x").get<std::string>(), measured_in.at("y").get<std::string>());
  for (const auto& point : answer.at("target").at("control_points"))
    fmt::print("{:>12.6g} {:>12.6g}\n", point.at(0).get<double>(), point.at(1).get<double>());
}

}  // namespace

void add_curve_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<CurveArguments>();
  CLI::App* command = program.add_subcommand("curve", "Reduce a measured curve to the control points of a target");
  command->add_option("file", arguments->file, "Table of measurements, or - for standard input")->required();
  command->add_option("--task", arguments->task, "What was measured (stress_strain)")
      ->check(CLI::IsMember({"stress_strain", "stiffness", "poisson"}));
  add_measured_curve_options(*command, arguments->measured);
  command->add_option("--out", arguments->out_file,
                      "Write the control points to this file, for --target-points; - for the terminal");
  command->footer(
      "Examples:\n  supple curve tensile.csv --out target.csv\n"
      "  supple curve tensile.txt --columns Extension,Load --units mm,N --gauge-length 50 --area 24");
  command->callback([&options, arguments] { run(options, *arguments); });
}

}  // namespace supple::cli
