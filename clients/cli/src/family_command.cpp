#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <vector>

#include "commands.h"
#include "failure.h"
#include "family_atlas_command.h"
#include "training_command.h"

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

/// The definition in a file, which may also be what `families --json` has printed of one family.
nlohmann::json definition_in_file(const std::string& file) {
  const nlohmann::json content = object_in_file(file);
  return content.contains("definition") ? content.at("definition") : content;
}

void check(const GlobalOptions& options, const std::string& file) {
  Session session(options);
  const auto answer = session.compute("/v1/family-checks", {{"definition", definition_in_file(file)}}).json();
  if (session.json()) return print_json(answer);
  print_findings(answer.at("faults"), "fault");
  print_findings(answer.at("warnings"), "warning");
  const bool good = answer.at("good").get<bool>();
  fmt::print("{}\n", good ? "The definition is one of a family." : "The definition is none of a family.");
  if (!good) throw Failure(ExitCode::violations, "the definition has faults");
}

/// A family that is to be added: with a type, the file is a drawing of its tile.
struct NewFamily {
  std::string file;
  std::string type;
  std::string id;
};

void add_family(const GlobalOptions& options, const NewFamily& family) {
  Session session(options);
  nlohmann::json request;
  if (family.type.empty()) {
    request = {{"definition", definition_in_file(family.file)}};
  } else {
    request = {{"svg", read_file(family.file)}, {"type", family.type}, {"id", family.id}};
  }
  const auto answer = session.http().post("/v1/families", request.dump(), "application/json").json();
  if (session.json()) return print_json(answer);
  print_findings(answer.at("warnings"), "warning");
  print_family(answer.at("family"));
}

/// Shows a family; all of them where it is empty.
void show_families(const GlobalOptions& options, const std::string& family) {
  Session session(options);
  const nlohmann::json answer = session.http().get(family.empty() ? "/v1/families" : "/v1/families/" + family).json();
  if (session.json()) return print_json(answer);
  family.empty() ? list_families(answer.at("families")) : print_family(answer);
}

void print_definition(const GlobalOptions& options, const std::string& family) {
  Session session(options);
  fmt::print("{}", session.http().get("/v1/families/" + family + "/definition", "text/plain").body);
}

void add_add_command(CLI::App& families, const GlobalOptions& options) {
  CLI::App* add = families.add_subcommand("add", "Add a family of one's own, which is checked and stored");
  const auto added = std::make_shared<NewFamily>();
  add->add_option("file", added->file, "File with the definition of a family, or with --type an SVG drawing of a tile")
      ->required();
  CLI::Option* type = add->add_option("--type", added->type, "Isohedral type of the drawn tile, for example IH21");
  CLI::Option* id = add->add_option("--id", added->id, "Id of the family of the drawn tile");
  type->needs(id);
  id->needs(type);
  add->footer("Examples:\n  supple families add family.json\n  supple families add tile.svg --type IH41 --id own");
  add->callback([&options, added] { add_family(options, *added); });
}

/// What is done with families, in the order in which the help lists it.
void add_family_subcommands(CLI::App& families, const GlobalOptions& options) {
  families.require_subcommand(0, 1);
  const auto named = std::make_shared<std::string>();
  families.add_subcommand("list", "List the families of tilings, one's own after those of the server")
      ->callback([&options] { show_families(options, {}); });
  CLI::App* show = families.add_subcommand("show", "Describe a family");
  show->add_option("family", *named, "Id of the family")->required();
  show->callback([&options, named] { show_families(options, *named); });
  CLI::App* definition =
      families.add_subcommand("definition", "Print the definition of a family as text, which supple-lab reads");
  definition->add_option("family", *named, "Id of the family")->required();
  definition->callback([&options, named] { print_definition(options, *named); });
  add_family_atlas_command(families, options);
  add_training_command(families, options);
  add_add_command(families, options);
  CLI::App* remove = families.add_subcommand("remove", "Remove a family of one's own");
  remove->add_option("family", *named, "Id of the family")->required();
  remove->callback([&options, named] {
    Session session(options);
    session.http().erase("/v1/families/" + *named);
  });
}

}  // namespace

void add_family_command(CLI::App& program, const GlobalOptions& options) {
  const auto family = std::make_shared<std::string>();
  const auto file = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand(
      "families", "List and describe families of tilings, check and add one's own, and say what they can do");
  CLI::Option* described = command->add_option("family", *family, "Family to describe; without one all are listed");
  command->add_option("--check", *file, "File with a definition of a family to check")->excludes(described);
  command->footer(
      "Examples:\n  supple families\n  supple families IH21\n  supple families --check family.json\n"
      "  supple families atlas IH21\n  supple families add family.json\n  supple families remove own");
  command->callback([&options, command, family, file] {
    if (!command->get_subcommands().empty()) return;  // which has run
    file->empty() ? show_families(options, *family) : check(options, *file);
  });
  add_family_subcommands(*command, options);
}

}  // namespace supple::cli
