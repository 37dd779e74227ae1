#include "problem_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>
#include <utility>

#include "command_tree.h"
#include "numbers.h"
#include "suggestions.h"

namespace supple::cli {
namespace {

/// A field whose option has another name, for one command or, if that is empty, for all. Fields within the field belong
/// to the same option. A command is named by its last words.
struct FieldName {
  std::string_view command;
  std::string_view pointer;
  std::string_view name;
};
constexpr std::array<FieldName, 46> field_names{{
    {"design", "/target/control_points", "--target"},
    {"design", "/text", "--target"},
    {"design", "/outline", "--part"},
    {"design", "/content", "--target"},
    {"design", "/units", "--units"},
    {"design", "/columns", "--columns"},
    {"curve", "/text", "file"},
    {"curve", "/content", "file"},
    {"curve", "/units", "--units"},
    {"curve", "/columns", "--columns"},
    {"curve", "/accuracy/max_control_points", "--control-points"},
    {"evaluate", "/green_strain", "--strain"},
    {"simulate", "/load/uniaxial/direction", "--uniaxial"},
    {"simulate", "/load/biaxial/direction", "--biaxial"},
    {"simulate", "/load/biaxial/stretches", "--stretches or --orthogonal"},
    {"relax", "/points/barycentric", "--per-face"},
    {"relax", "/points/radius", "--poisson-disk"},
    {"relax", "/fixed_points", "--fixed"},
    {"relax", "/spring_length", "--euclidean"},
    {"relax", "/host/fixed_vertices", "--fix-vertex"},
    {"relax", "/host/moved_vertices", "--move-vertex"},
    {"relax", "/host/kind", "--host-kind"},
    {"relax", "/host/thickness", "--host-thickness"},
    {"relax", "/host/youngs_modulus", "--host-youngs-modulus"},
    {"relax", "/host/poisson_ratio", "--host-poisson-ratio"},
    {"voronoi", "/sites/count", "--random"},
    {"voronoi", "/objectives", "--optimize"},
    {"voronoi", "/fixed_sites", "--fixed"},
    {"weave simulate", "/supports", "--hold or --move"},
    {"weave simulate", "/forces", "--pull"},
    {"part simulate", "/supports", "--support"},
    {"part simulate", "/accuracy/tolerance", "--residual"},
    {"part simulate", "/part/regions", "--region"},
    {"part simulate", "/part/structure/family", "family"},
    {"part simulate", "/text", "--outline"},
    {"part simulate", "/resolution", "--resolution"},
    {"print", "/printer", "--profile"},
    {"print", "/overruns", "--overrun-of"},
    {"check", "/gcode", "file"},
    {"part", "/text", "--outline"},
    {"part", "/regions", "--region"},
    {"outlines", "/text", "file"},
    {"outlines", "/resolution", "--resolution"},
    {"part", "/resolution", "--resolution"},
    {"", "/weave/overrides", "--fuse or --slide"},
    {"", "/weave/pattern", "weave"},
}};

/// Options whose values are files of whole requests or of parts of them.
constexpr std::array<const char*, 6> request_files{"request", "network", "options", "load", "profile", "limits"};

/// Advice for problems whose hint by the server is for authors of requests.
constexpr std::array<std::pair<std::string_view, std::string_view>, 7> hints{{
    {"mesh.not_found", "See 'supple mesh list', or name a mesh file, which is uploaded."},
    {"point.vertex_out_of_range", "Vertices are numbered from 0; 'supple mesh show' says how many there are."},
    {"point.face_out_of_range", "Faces are numbered from 0; 'supple mesh show' says how many there are."},
    {"job.not_found", "See 'supple job list'."},
    {"model.not_found", "See 'supple models'."},
    {"tiling.family_not_found", "See 'supple families'."},
    {"design.no_model", "See 'supple models'."},
}};

std::vector<std::string> parts_of(const std::string& pointer) {
  std::vector<std::string> parts;
  std::istringstream text(pointer);
  for (std::string part; std::getline(text, part, '/');)
    if (!part.empty()) parts.push_back(replaced(replaced(part, "~1", "/"), "~0", "~"));
  return parts;
}

bool lies_within(const std::string& pointer, std::string_view field) {
  return pointer.starts_with(field) && (pointer.size() == field.size() || pointer[field.size()] == '/');
}

const CLI::Option* option_named(const CLI::App& app, const std::string& part) {
  const std::string name = replaced(part, "_", "-");
  std::vector<std::string> names{name};
  // An option may be repeated for each entry of a list: --spring for springs.
  if (name.ends_with('s')) names.push_back(name.substr(0, name.size() - 1));
  for (const auto& one : names)
    for (const CLI::Option* option : app.get_options())
      if (option->check_lname(one) || (one.size() == 1 && option->check_sname(one)) ||
          option->get_name(/*positional=*/true) == one)
        return option;
  return nullptr;
}

std::string shown_name(const CLI::Option& option) {
  return option.nonpositional() ? spellings(option).back() : option.get_name(/*positional=*/true);
}

/// The value from which an entry of a list came, if an option has several values: " 'v9'".
std::string quoted_value(const CLI::Option& option, const std::vector<std::string>& parts, std::size_t at) {
  if (at + 1 >= parts.size() || option.get_items_expected_max() <= 1) return {};
  const auto index = integer_in(parts[at + 1]);
  const auto& values = option.results();
  if (!index || *index < 0 || static_cast<std::size_t>(*index) >= values.size()) return {};
  return fmt::format(" '{}'", values[static_cast<std::size_t>(*index)]);
}

/// The place of a fault in an option's value: an index in a list (" at index 1", from 0), or the name of an entry
/// (" 'beauty'").
std::string place_in_value(const std::vector<std::string>& parts, std::size_t at) {
  const auto index = std::find_if(parts.begin() + static_cast<std::ptrdiff_t>(std::min(at, parts.size())), parts.end(),
                                  [](const std::string& part) { return integer_in(part).has_value(); });
  if (index != parts.end()) return " at index " + *index;
  return at + 1 == parts.size() ? fmt::format(" '{}'", parts[at]) : std::string();
}

/// The point on the command line for an end of a geodesic; the points are the start and the end of each one in turn.
std::string name_of_end(const CLI::App& command, const std::vector<std::string>& parts) {
  const CLI::Option* points = option_named(command, "points");
  const auto pair = parts.size() > 2 ? integer_in(parts[1]) : std::nullopt;
  if (points == nullptr || !pair) return "points";
  const auto at = static_cast<std::size_t>(2 * *pair + (parts[2] == "to" ? 1 : 0));
  return at < points->results().size() ? fmt::format("points '{}'", points->results()[at]) : "points";
}

/// Whether the words that call the command are, or end with, these words.
bool is_called(const std::vector<const CLI::App*>& commands, std::string_view words) {
  const std::string called = " " + command_line_of(commands);
  return called.ends_with(" " + std::string(words));
}

/// Whether a command reads a request, or part of one, from a file: the last one, or one before it, whose options the
/// last one passes on.
bool reads_request_file(const std::vector<const CLI::App*>& commands) {
  return std::any_of(commands.begin(), commands.end(), [](const CLI::App* command) {
    return std::any_of(request_files.begin(), request_files.end(), [&](const char* name) {
      const CLI::Option* option = command->get_option_no_throw("--" + std::string(name));
      return option != nullptr && option->count() > 0;
    });
  });
}

/// The option of the last command that has one of this name, and else of the one before it.
const CLI::Option* option_of(const std::vector<const CLI::App*>& commands, const std::string& part) {
  for (auto command = commands.rbegin(); command != commands.rend(); ++command)
    if (const CLI::Option* option = option_named(**command, part)) return option;
  return nullptr;
}

/// The server's sentence with the option in place of the field that it names, with or without its first slash.
std::string with_name_of_field(const std::string& sentence, const std::string& pointer, const std::string& name) {
  const std::string text = replaced(sentence, pointer, name);
  const std::string bare = pointer.substr(1);
  // A single word may occur in the sentence with another meaning.
  if (bare.find('/') != std::string::npos) return replaced(text, bare, name);
  return text.starts_with(bare + ":") ? name + text.substr(bare.size()) : text;
}

std::string hint_of(const nlohmann::json& document) {
  const auto code = member_text(document, "code");
  for (const auto& [known, hint] : hints)
    if (code == known) return std::string(hint);
  auto hint = member_text(document, "hint");
  // Hints with these words are for authors of requests.
  for (const char* const word : {"/openapi.yaml", "/v1/", "entries of errors", "entry of errors", "The message names"})
    if (hint.find(word) != std::string::npos) return {};
  return hint;
}

}  // namespace

std::string name_of_field(const std::string& pointer, const std::vector<const CLI::App*>& commands) {
  const auto parts = parts_of(pointer);
  const CLI::App& command = *commands.back();
  if (parts.empty()) return "the request";
  auto field = "the field " + joined(parts, ".");
  const bool from_file = reads_request_file(commands);
  if (command.get_name() == "geodesic" && parts.front() == "pairs") return name_of_end(command, parts);
  for (const auto& known : field_names) {
    const bool is_of_command = known.command.empty() || is_called(commands, known.command);
    if (!is_of_command || !lies_within(pointer, known.pointer)) continue;
    if (from_file) return field;
    const CLI::Option* const points = command.get_option_no_throw("--target-points");
    if (known.name == "--target" && points != nullptr && points->count() > 0) return "--target-points";
    // The index counts the entries of several options together, so that it does not identify an entry of one.
    const bool several = known.name.find(" or ") != std::string_view::npos;
    return std::string(known.name) +
           (several ? "" : place_in_value(parts, parts_of(std::string(known.pointer)).size()));
  }
  for (std::size_t at = parts.size(); at-- > 0;) {
    const CLI::Option* option = option_of(commands, parts[at]);
    if (option == nullptr) continue;
    if (from_file && option->count() == 0) return field;
    const auto quoted = quoted_value(*option, parts, at);
    const bool is_list = at + 1 < parts.size() && integer_in(parts[at + 1]);
    return shown_name(*option) + (quoted.empty() && is_list ? place_in_value(parts, at + 1) : quoted);
  }
  return field;
}

std::string problem_message(const Problem& problem, const CLI::App& program) {
  const auto commands = given_commands(program);
  const auto& document = problem.document();
  std::string sentence = problem.what();
  std::vector<std::pair<std::string, std::string>> faults;
  if (const auto errors = document.find("errors"); errors != document.end() && errors->is_array()) {
    for (const auto& entry : *errors) {
      if (!entry.is_object()) continue;
      const auto pointer = member_text(entry, "pointer");
      const bool is_field = pointer.starts_with('/');
      faults.emplace_back(is_field ? name_of_field(pointer, commands) : pointer, member_text(entry, "detail"));
      if (is_field) sentence = with_name_of_field(sentence, pointer, faults.back().first);
    }
  }
  if (faults.size() == 1 && faults.front().second == sentence)
    sentence = fmt::format("{}: {}", faults.front().first, sentence);
  std::string message = fmt::format("{} [{}, HTTP {}]", sentence, member_text(document, "code"), problem.status());
  for (const auto& [place, detail] : faults) {
    const bool is_in_sentence = sentence.find(place) != std::string::npos && sentence.find(detail) != std::string::npos;
    if (!is_in_sentence) message += fmt::format("\n  {}{}{}", place, place.empty() ? "" : ": ", detail);
  }
  if (const auto hint = hint_of(document); !hint.empty()) message += "\n" + hint;
  return message;
}

}  // namespace supple::cli
