#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <vector>

#include "commands.h"
#include "failure.h"
#include "family_atlas_command.h"

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

void print_findings(const nlohmann::json& findings, const char* kind) {
  for (const auto& finding : findings) {
    fmt::print("{} ({}): {} {}\n", kind, finding.at("flaw").get<std::string>(),
               finding.at("pointer").get<std::string>(), finding.at("message").get<std::string>());
  }
}

/// Checks the definition in a file, which may also be what `families --json` has printed of one family.
void check(const GlobalOptions& options, const std::string& file) {
  Session session(options);
  nlohmann::json definition = object_in_file(file);
  if (definition.contains("definition")) definition = nlohmann::json(definition.at("definition"));
  const auto answer = session.compute("/v1/family-checks", {{"definition", definition}}).json();
  if (session.json()) return print_json(answer);
  print_findings(answer.at("faults"), "fault");
  print_findings(answer.at("warnings"), "warning");
  const bool good = answer.at("good").get<bool>();
  fmt::print("{}\n", good ? "The definition is one of a family." : "The definition is none of a family.");
  if (!good) throw Failure(ExitCode::violations, "the definition has faults");
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
  const auto file = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand("families", "List the families of tilings, or describe one");
  CLI::Option* described = command->add_option("family", *family, "Family to describe");
  command->add_option("--check", *file, "File with a definition of a family to check")->excludes(described);
  command->footer(
      "Examples:\n  supple families\n  supple families IH21\n  supple families --check family.json\n"
      "  supple families atlas IH21");
  CLI::App* atlas = add_family_atlas_command(*command, options);
  command->callback([&options, family, file, atlas] {
    if (atlas->parsed()) return;
    file->empty() ? run(options, *family) : check(options, *file);
  });
}

}  // namespace supple::cli
