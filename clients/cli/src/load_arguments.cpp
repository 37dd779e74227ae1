#include "load_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <utility>

#include "angles.h"
#include "failure.h"
#include "numbers.h"
#include "session.h"
#include "units.h"

namespace supple::cli {
namespace {

std::vector<double> stretches_of(const LoadArguments& arguments) {
  if (arguments.stretches.empty()) throw Failure(ExitCode::usage, "--uniaxial and --biaxial need --stretches");
  return parse_series(arguments.stretches, "list of stretches");
}

nlohmann::json biaxial_stretches(const LoadArguments& arguments) {
  if (arguments.orthogonal.empty()) throw Failure(ExitCode::usage, "--biaxial needs --orthogonal");
  const auto along = stretches_of(arguments);
  auto across = parse_series(arguments.orthogonal, "list of stretches");
  if (across.size() == 1) across.resize(along.size(), across.front());
  if (across.size() != along.size()) {
    throw Failure(ExitCode::usage, fmt::format("--stretches has {} numbers, --orthogonal {}: give as many, or one",
                                               along.size(), across.size()));
  }
  auto pairs = nlohmann::json::array();
  for (std::size_t i = 0; i < along.size(); ++i) pairs.push_back({along[i], across[i]});
  return pairs;
}

}  // namespace

std::vector<std::string> parse_rows(const std::string& argument, bool& is_file) {
  std::error_code ignored;
  is_file = std::filesystem::is_regular_file(argument, ignored) || looks_like_path(argument);
  return rows_in(is_file ? read_file(argument) : argument);
}

std::vector<std::string> rows_in(std::string text) {
  std::replace(text.begin(), text.end(), ';', '\n');
  std::vector<std::string> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    line.erase(std::remove_if(line.begin(), line.end(), [](char c) { return c == ' ' || c == '\t' || c == '\r'; }),
               line.end());
    if (!line.empty() && line.front() != '#') rows.push_back(line);
  }
  return rows;
}

nlohmann::json parse_green_strains(const std::string& argument) {
  bool is_file = false;
  auto strains = nlohmann::json::array();
  for (const auto& row : parse_rows(argument, is_file)) {
    const auto strain = quantities_in(row, {Dimension::ratio});
    if (!strain || strain->size() != 3) {
      throw Failure(
          is_file ? ExitCode::local_file : ExitCode::usage,
          fmt::format("'{}' is no Green strain: write xx,yy,xy for each, one in a line or separated by ;", row));
    }
    strains.push_back(*strain);
  }
  return strains;
}

void add_load_options(CLI::App& command, LoadArguments& arguments) {
  auto* const uniaxial =
      command.add_option("--uniaxial", arguments.uniaxial,
                         "Stretch along this direction, for example 45deg; lateral strain and shear are free");
  auto* const biaxial = command.add_option("--biaxial", arguments.biaxial,
                                           "Stretch along this direction, for example 45deg, and orthogonal to it");
  command
      .add_option("--stretches", arguments.stretches,
                  "Stretches along the direction in their order: 1.05,1.1 or first:last:n")
      ->transform(quantity(Dimension::ratio));
  command.add_option("--orthogonal", arguments.orthogonal, "Stretches orthogonal to it, as many or one")
      ->transform(quantity(Dimension::ratio));
  command
      .add_option("--frame", arguments.frame,
                  "What --uniaxial is a direction of: space (the default), or the material, as of models and designs")
      ->check(CLI::IsMember({"space", "material"}));
  auto* const strain = command.add_option("--green-strain", arguments.green_strain,
                                          "Impose Green strains xx,yy,xy;xx,yy,xy or those in the lines of a file");
  uniaxial->excludes(biaxial)->excludes(strain);
  biaxial->excludes(strain);
}

nlohmann::json load_of(const LoadArguments& arguments) {
  if (!arguments.uniaxial.empty()) {
    nlohmann::json load = {{"direction", parse_angle(arguments.uniaxial, "--uniaxial")},
                           {"stretches", stretches_of(arguments)}};
    if (!arguments.frame.empty()) load["frame"] = arguments.frame;
    return {{"uniaxial", std::move(load)}};
  }
  if (!arguments.frame.empty()) throw Failure(ExitCode::usage, "--frame belongs to --uniaxial");
  if (!arguments.biaxial.empty()) {
    return {
        {"biaxial",
         {{"direction", parse_angle(arguments.biaxial, "--biaxial")}, {"stretches", biaxial_stretches(arguments)}}}};
  }
  if (!arguments.green_strain.empty()) return {{"green_strain", parse_green_strains(arguments.green_strain)}};
  throw Failure(ExitCode::usage, "no load: give --uniaxial, --biaxial or --green-strain");
}

}  // namespace supple::cli
