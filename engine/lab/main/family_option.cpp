#include "family_option.h"

#include <CLI/Option.hpp>
#include <fstream>
#include <iterator>
#include <memory>
#include <utility>

#include "supple/base/error.h"
#include "supple/tiling/definition_check.h"
#include "supple/tiling/definition_text.h"

namespace supple::lab {
namespace {

std::shared_ptr<const tiling::Family> family_in(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error("file.unreadable", "The file " + path.string() + " cannot be read.");
  auto definition = tiling::definition_of_text(std::string(std::istreambuf_iterator<char>(file), {}));
  const auto report = tiling::check_definition(definition);
  if (!report.good())
    throw Error("family.faulty", "The definition is not one of a family: " + report.faults.front().where + " " +
                                     report.faults.front().message + ".");
  return std::make_shared<const tiling::Family>(tiling::make_family(std::move(definition)));
}

}  // namespace

void add_family_options(CLI::App& command, FamilyOption& option) {
  CLI::Option* family = command.add_option("--family", option.family, "Id of a shipped family, for example IH21");
  command.add_option("--definition", option.definition, "Instead: a file with the text of a family's definition")
      ->excludes(family);
}

void set_family(const FamilyOption& option, DatasetOptions& options) {
  if (option.family.empty() == option.definition.empty())
    throw Error("dataset.invalid_option", "Either --family or --definition is required.",
                {{"family", "or a definition is required"}});
  options.family = option.family;
  if (option.definition.empty()) return;
  options.own_family = family_in(option.definition);
  options.family = options.own_family->id;
}

}  // namespace supple::lab
