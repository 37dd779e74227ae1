#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <vector>

#include "commands.h"

namespace supple::cli {
namespace {

void print_family(const nlohmann::json& family) {
  const auto& parameters = family.at("parameters");
  const auto& cell = family.at("cell");
  fmt::print("family      {}: {}\n", family.at("id").get<std::string>(), family.at("description").get<std::string>());
  fmt::print("parameters  {:>8} {:>8} {:>8}\n", "lower", "upper", "default");
  // Older servers send no definition.
  const auto definition = family.value("definition", nlohmann::json());
  for (std::size_t i = 0; i < parameters.at("lower").size(); ++i) {
    const auto words =
        definition.is_object() ? definition.at("parameters").at(i).at("description").get<std::string>() : std::string();
    fmt::print("  {:<9} {:>8g} {:>8g} {:>8g}{}{}\n", i + 1, parameters.at("lower").at(i).get<double>(),
               parameters.at("upper").at(i).get<double>(), parameters.at("default").at(i).get<double>(),
               words.empty() ? "" : "  ", words);
  }
  fmt::print("beams       {:g} mm wide ({:g} tiling units; one is {:.6g} mm)\n",
             family.at("printed_beam_width").get<double>(), family.at("beam_width").get<double>(),
             family.at("scale").get<double>());
  fmt::print("cell        {} tiles, {:.6g} mm^2, {:.3g} % solid\n", cell.at("tiles").get<int>(),
             cell.at("area").get<double>(), 100 * cell.at("relative_density").get<double>());
}

void list_families(const nlohmann::json& families) {
  for (const auto& family : families) {
    const auto presets = family.at("parameters").at("default").get<std::vector<double>>();
    fmt::print("{:<8}  {} parameters ({:g})  {}\n", family.at("id").get<std::string>(), presets.size(),
               fmt::join(presets, ","), family.at("description").get<std::string>());
  }
}

void run(const GlobalOptions& options, const std::string& family) {
  Session session(options);
  const nlohmann::json answer = session.http().get(family.empty() ? "/v1/families" : "/v1/families/" + family).json();
  if (session.json()) return print_json(answer);
  family.empty() ? list_families(answer.at("families")) : print_family(answer);
}

}  // namespace

void add_family_command(CLI::App& program, const GlobalOptions& options) {
  const auto family = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand("families", "List the families of tilings, or describe one");
  command->add_option("family", *family, "Family to describe");
  command->footer("Examples:\n  supple families\n  supple families IH21");
  command->callback([&options, family] { run(options, *family); });
}

}  // namespace supple::cli
