#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "commands.h"
#include "drawing_arguments.h"

namespace supple::cli {
namespace {

struct OutlinesArguments {
  std::string file;
  DrawingArguments drawing;
};

std::string joined_names(const nlohmann::json& names) {
  std::string words;
  for (const auto& name : names) words += (words.empty() ? "" : ", ") + name.get<std::string>();
  return words.empty() ? "-" : words;
}

void print_polygon(const nlohmann::json& polygon) {
  double lower[2] = {1e300, 1e300}, upper[2] = {-1e300, -1e300};
  for (const auto& point : polygon.at("points")) {
    for (int k = 0; k < 2; ++k) {
      const double value = point.at(k).get<double>();
      lower[k] = std::min(lower[k], value);
      upper[k] = std::max(upper[k], value);
    }
  }
  fmt::print("{:>8} {:>10.5g} x {:<10.5g} {}\n", polygon.at("points").size(), upper[0] - lower[0], upper[1] - lower[1],
             joined_names(polygon.at("names")));
}

void run(const GlobalOptions& options, const OutlinesArguments& arguments) {
  Session session(options);
  const auto answer = read_drawing(session, arguments.file, arguments.drawing);
  if (session.json()) return print_json(answer);
  const auto& size = answer.at("size");
  fmt::print("{} closed curves, {:.6g} x {:.6g} mm; chords lie within {:.2g} mm of them\n",
             answer.at("polygons").size(), size.at(0).get<double>(), size.at(1).get<double>(),
             answer.at("chord_error").get<double>());
  fmt::print("{:>8} {:>23} {}\n", "corners", "size, mm", "names");
  for (const auto& polygon : answer.at("polygons")) print_polygon(polygon);
  const auto count = answer.at("left_out_count").get<std::size_t>();
  if (count == 0) return;
  constexpr std::size_t max_listed = 20;
  fmt::print("left out:\n");
  const auto& left_out = answer.at("left_out");
  for (std::size_t k = 0; k < std::min(left_out.size(), max_listed); ++k)
    fmt::print("  {}: {}\n", left_out[k].at("element").get<std::string>(), left_out[k].at("reason").get<std::string>());
  if (count > max_listed) fmt::print("  and {} more\n", count - max_listed);
}

}  // namespace

void add_outlines_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<OutlinesArguments>();
  CLI::App* command = program.add_subcommand("outlines", "The closed curves of an SVG or DXF drawing, and their names");
  command->add_option("file", arguments->file, "SVG or ASCII DXF file, or - for standard input")->required();
  add_drawing_options(*command, arguments->drawing);
  command->footer("Example:\n  supple outlines sole.svg --tolerance 0.02");
  command->callback([&options, arguments] { run(options, *arguments); });
}

}  // namespace supple::cli
