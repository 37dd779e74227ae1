#include "weave_print_commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "failure.h"
#include "numbers.h"
#include "units.h"
#include "weave_arguments.h"
#include "weave_print_output.h"

namespace supple::cli {
namespace {

struct PrintArguments {
  WeaveArguments weave;
  std::string gcode_file;
  std::string svg_file;
  std::string profile_file;
  std::string options_file;
  std::string origin;
  std::string order;
  std::string overrun;
  std::vector<std::string> overruns;
  double loop_overlap = 0;
  std::string frame;
  std::vector<std::string> grips;
  double chord_error = 0;
  double deadline = 0;
};

/// Numbers separated by commas, from `min_count` to `max_count` of them. Throws Failure(usage) that shows an example.
std::vector<double> numbers_of(const std::string& text, const char* what, std::size_t min_count, std::size_t max_count,
                               const char* example) {
  auto numbers = parse_numbers(text, what);
  if (numbers.size() < min_count || numbers.size() > max_count)
    throw Failure(ExitCode::usage, fmt::format("'{}' is no {}: write for example {}", text, what, example));
  return numbers;
}

/// The overrun of strands in mm, from "24" for both ends or "24,0" for start and end.
nlohmann::json parse_overrun(const std::string& text) {
  const auto lengths = numbers_of(text, "overrun", 1, 2, "24 or 24,0");
  return {{"start", lengths.front()}, {"end", lengths.back()}};
}

/// A strand and its overrun, from "3:24" or "3:24,0".
nlohmann::json parse_overrun_of_strand(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto strand = integer_in(std::string_view(text).substr(0, colon));
  if (!strand || colon == std::string::npos)
    throw Failure(ExitCode::usage, fmt::format("'{}' is no strand with its overrun: write for example 3:24,0", text));
  nlohmann::json overrun = parse_overrun(text.substr(colon + 1));
  overrun["strand"] = *strand;
  return overrun;
}

nlohmann::json parse_grip(const std::string& text) {
  const auto numbers = numbers_of(text, "grip", 4, 5, "x,y,x,y or x,y,x,y,width");
  nlohmann::json grip = {{"from", {numbers[0], numbers[1]}}, {"to", {numbers[2], numbers[3]}}};
  if (numbers.size() == 5) grip["width"] = numbers[4];
  return grip;
}

nlohmann::json request_of(const PrintArguments& arguments) {
  nlohmann::json request =
      arguments.options_file.empty() ? nlohmann::json::object() : object_in_file(arguments.options_file);
  request["weave"] = weave_of(arguments.weave);
  if (!arguments.profile_file.empty()) request["printer"] = object_in_file(arguments.profile_file);
  if (!arguments.origin.empty()) request["origin"] = numbers_of(arguments.origin, "origin", 2, 2, "50,50");
  if (!arguments.order.empty()) {
    request["order"] = nlohmann::json::array();
    for (const double strand : parse_numbers(arguments.order, "list of strands"))
      request["order"].push_back(static_cast<long>(strand));
  }
  if (!arguments.overrun.empty()) request["overrun"] = parse_overrun(arguments.overrun);
  for (const auto& text : arguments.overruns) request["overruns"].push_back(parse_overrun_of_strand(text));
  if (arguments.loop_overlap > 0) request["loop_overlap"] = arguments.loop_overlap;
  if (!arguments.frame.empty()) {
    const auto lengths = numbers_of(arguments.frame, "frame", 1, 2, "2 or 2,16");
    request["frame"] = {{"margin", lengths[0]}};
    if (lengths.size() == 2) request["frame"]["lead_in"] = lengths[1];
  }
  for (const auto& text : arguments.grips) request["grips"].push_back(parse_grip(text));
  if (arguments.chord_error > 0) request["chord_error"] = arguments.chord_error;
  if (arguments.deadline > 0) request["deadline"] = arguments.deadline;
  return request;
}

void print_weave(const GlobalOptions& options, const PrintArguments& arguments) {
  nlohmann::json request = request_of(arguments);
  auto& include = request["include"] = nlohmann::json::array();
  if (!arguments.gcode_file.empty()) include.push_back("gcode");
  if (!arguments.svg_file.empty()) include.push_back("svg");
  Session session(options);
  const nlohmann::json answer = session.compute("/v1/weave-toolpaths", request).json();
  if (!arguments.gcode_file.empty()) write_file(arguments.gcode_file, answer.at("gcode").get<std::string>());
  if (!arguments.svg_file.empty()) write_file(arguments.svg_file, answer.at("svg").get<std::string>());
  if (arguments.gcode_file != "-" && arguments.svg_file != "-")
    session.json() ? print_json(answer) : print_toolpath(answer);
  fail_on_violations(answer.at("check"));
}

void add_weave_print_command(CLI::App& weave, const GlobalOptions& options) {
  const auto arguments = std::make_shared<PrintArguments>();
  CLI::App* command = weave.add_subcommand("print", "G-code that prints a sheet, checked");
  add_weave_options(*command, arguments->weave);
  command->add_option("-o,--output", arguments->gcode_file, "Write the G-code to this file, - for the terminal");
  command->add_option("--svg", arguments->svg_file, "Write a picture of the toolpath, - for the terminal");
  command->add_option("--profile", arguments->profile_file,
                      "JSON file with the printer as the contract has it (a Prusa i3 MK3S with PLA)");
  command->add_option("--options", arguments->options_file, "JSON file with any fields of the request");
  command->add_option("--origin", arguments->origin, "Where the sheet's 0,0 comes to lie on the bed, in mm (centred)")
      ->transform(quantity(Dimension::length));
  command->add_option("--order", arguments->order, "All strands in printing order: 3,0,1,2");
  command
      ->add_option("--overrun", arguments->overrun,
                   "Strands are printed on beyond their ends by mm: 24, or 24,0 for start and end")
      ->transform(quantity(Dimension::length));
  command->add_option("--overrun-of", arguments->overruns, "The same of single strands: 3:24,0")
      ->transform(quantity(Dimension::length));
  command->add_option("--loop-overlap", arguments->loop_overlap, "Loops are printed on over their beginning by mm")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber);
  command->add_option("--frame", arguments->frame, "A frame around the sheet: margin in mm, or margin,lead-in")
      ->transform(quantity(Dimension::length));
  command->add_option("--grip", arguments->grips, "A solid bar: x,y,x,y or x,y,x,y,width in mm")
      ->transform(quantity(Dimension::length));
  command->add_option("--chord-error", arguments->chord_error, "Polylines leave curved strands by less, in mm (0.005)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber);
  command->add_option("--deadline", arguments->deadline, "Seconds that the computation may take, or for example 2min")
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
  command->footer(
      "Examples:\n"
      "  supple weave print regular --sheet 20x20 --connections slides_y --overrun 24 --frame 0,16 -o sheet.gcode\n"
      "  supple weave print circles --type 2 --sheet 6x5 --loop-overlap 1.6 --grip=-8,0,80,0 -o a.gcode --svg a.svg");
  command->callback([&options, arguments] { print_weave(options, *arguments); });
}

struct CheckArguments {
  std::string gcode_file;
  std::string limits_file;
};

void check(const GlobalOptions& options, const CheckArguments& arguments) {
  // JSON can contain only text. Other bytes become '?', which is a fault too, except in comments, where any text is.
  std::string gcode = read_file(arguments.gcode_file);
  std::replace_if(
      gcode.begin(), gcode.end(), [](char c) { return static_cast<unsigned char>(c) > '~'; }, '?');
  nlohmann::json request = {{"gcode", std::move(gcode)}};
  if (!arguments.limits_file.empty()) request["limits"] = object_in_file(arguments.limits_file);
  Session session(options);
  const nlohmann::json answer = session.compute("/v1/gcode-reports", request).json();
  session.json() ? print_json(answer) : print_gcode_report(answer);
  fail_on_violations(answer.at("report"));
}

void add_weave_check_command(CLI::App& weave, const GlobalOptions& options) {
  const auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = weave.add_subcommand("check", "What a printer would do with a G-code file, and what is wrong");
  command->add_option("file", arguments->gcode_file, "G-code")->required();
  command->add_option("--limits", arguments->limits_file,
                      "JSON file with what it must keep to, as the contract has it");
  command->footer("The exit status is 6 where there are violations; they are listed with their lines.");
  command->callback([&options, arguments] { check(options, *arguments); });
}

}  // namespace

void add_weave_print_commands(CLI::App& weave, const GlobalOptions& options) {
  add_weave_print_command(weave, options);
  add_weave_check_command(weave, options);
}

}  // namespace supple::cli
