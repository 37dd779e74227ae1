#include "family_atlas_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <string>
#include <vector>

#include "failure.h"
#include "numbers.h"
#include "units.h"

namespace supple::cli {
namespace {

struct AtlasArguments {
  std::string subject;
  int samples = 0;
  int error_samples = -1;
  double mesh_size = 0;
  std::string crossings;
  bool recompute = false;
  double deadline = 0;
  std::string output;
};

/// The request of an atlas: of a definition in a file, of an isohedral type ("type-16"), or of a family.
nlohmann::json request_of(const AtlasArguments& arguments) {
  constexpr std::string_view type_prefix = "type-";
  nlohmann::json request;
  const std::string_view subject = arguments.subject;
  if (looks_like_path(arguments.subject)) {
    nlohmann::json definition = object_in_file(arguments.subject);
    if (definition.contains("definition")) definition = nlohmann::json(definition.at("definition"));
    request["definition"] = definition;
  } else if (const auto number =
                 subject.starts_with(type_prefix) ? integer_in(subject.substr(type_prefix.size())) : std::nullopt) {
    request["isohedral_type"] = *number;
  } else {
    request["family"] = arguments.subject;
  }
  if (arguments.samples > 0) request["samples"] = arguments.samples;
  if (arguments.error_samples >= 0) request["error_samples"] = arguments.error_samples;
  if (arguments.mesh_size > 0) request["mesh_size"] = arguments.mesh_size;
  if (!arguments.crossings.empty()) request["crossings"] = arguments.crossings == "on";
  if (arguments.recompute) request["recompute"] = true;
  if (arguments.deadline > 0) request["deadline"] = arguments.deadline;
  return request;
}

void print_places(const nlohmann::json& atlas) {
  const auto& places = atlas.at("places");
  fmt::print("family      {}, {} samples of its bounds\n", atlas.at("family").get<std::string>(),
             atlas.at("samples").size());
  std::vector<std::string> parts;
  for (const auto* name : {"good", "sliver", "crossing", "closed", "unsolved"})
    if (const int count = places.at(name).get<int>(); count > 0) parts.push_back(fmt::format("{} {}", count, name));
  fmt::print("places      {}\n", fmt::join(parts, ", "));
  for (const auto& warning : atlas.at("warnings"))
    fmt::print("  {}: {} {}\n", warning.at("flaw").get<std::string>(), warning.at("pointer").get<std::string>(),
               warning.at("message").get<std::string>());
  if (const auto& error = atlas.at("mesh_error"); !error.is_null()) {
    fmt::print(
        "mesh        sides of {:g} beam widths; the stiffness errs by {:.2g} % (median of {}; at most {:.2g} %)\n",
        atlas.at("mesh_size").get<double>(), 100 * error.at("median").get<double>(), error.at("samples").get<int>(),
        100 * error.at("largest").get<double>());
  }
}

std::string percent_text(const nlohmann::json& reached) {
  return fmt::format("{:.1f}{}", 100 * reached.at("deviation").get<double>(),
                     reached.at("met").get<bool>() ? "*" : " ");
}

void print_profiles(const nlohmann::json& atlas) {
  fmt::print("{:<26} {:>11}  {:>18}  {}\n", "profile", "deviation %", "of other families", "nearest parameters");
  for (const auto& profile : atlas.at("profiles")) {
    const auto& others = profile.at("others");
    const auto& sample = atlas.at("samples").at(profile.at("sample").get<std::size_t>());
    const auto other = others.is_null()
                           ? std::string("-")
                           : fmt::format("{} ({})", percent_text(others), others.at("family").get<std::string>());
    fmt::print("{:<26} {:>11}  {:>18}  {:.4g}\n", profile.at("name").get<std::string>(), percent_text(profile), other,
               fmt::join(sample.at("parameters").get<std::vector<double>>(), ","));
  }
  fmt::print("* met: at most 2 %, or for Poisson's ratio at most 0.02\n");
}

void print_comparison(const nlohmann::json& comparison) {
  if (comparison.is_null()) return;
  fmt::print(
      "adds        {:.3g} % of its samples are far from all of {} (distance {:.2g} in the median, {:.2g} at most)\n",
      100 * comparison.at("new_fraction").get<double>(),
      fmt::join(comparison.at("families").get<std::vector<std::string>>(), ", "),
      comparison.at("median_distance").get<double>(), comparison.at("largest_distance").get<double>());
  if (const auto& same = comparison.at("same_as"); !same.is_null())
    fmt::print("            it is {} under another name\n", same.get<std::string>());
}

void run(const GlobalOptions& options, const AtlasArguments& arguments) {
  Session session(options);
  const auto answer = session.compute("/v1/family-atlases", request_of(arguments));
  if (!arguments.output.empty()) write_file(arguments.output, answer.body);
  if (arguments.output == "-") return;
  const nlohmann::json atlas = answer.json();
  if (session.json()) return print_json(atlas);
  print_places(atlas);
  print_profiles(atlas);
  print_comparison(atlas.at("comparison"));
  if (const auto why = atlas.at("stopped").get<std::string>(); why != "none")
    fmt::print("It has fewer samples than asked for: {}.\n",
               why == "deadline" ? "the deadline has passed" : "a limit of memory was reached");
}

}  // namespace

void add_family_atlas_command(CLI::App& families, const GlobalOptions& options) {
  const auto arguments = std::make_shared<AtlasArguments>();
  CLI::App* command = families.add_subcommand("atlas", "What a family can do at rest, and what it adds to the others");
  command
      ->add_option("family", arguments->subject,
                   "Family of the server or of one's own, isohedral type such as type-16, or file with a definition")
      ->required();
  command->add_option("--samples", arguments->samples, "Points of the bounds (256)")->check(CLI::PositiveNumber);
  command->add_option("--mesh-size", arguments->mesh_size, "Sides of triangles in beam widths (1)")
      ->check(CLI::PositiveNumber);
  command->add_option("--error-samples", arguments->error_samples, "Samples at which the mesh's error is measured (8)")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--crossings", arguments->crossings,
                   "Solve tilings that cross themselves (on for families of the server)")
      ->check(CLI::IsMember({"on", "off"}));
  command->add_flag("--recompute", arguments->recompute, "Compute it even if the server has it");
  command
      ->add_option("--deadline", arguments->deadline,
                   "Seconds that the computation may take, or for example 2min (600)")
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
  command->add_option("-o,--output", arguments->output, "Write the atlas as JSON to this file, - for the terminal");
  command->footer("Examples:\n  supple families atlas IH21\n  supple families atlas type-16 --output type16.json");
  command->callback([&options, arguments] { run(options, *arguments); });
}

}  // namespace supple::cli
