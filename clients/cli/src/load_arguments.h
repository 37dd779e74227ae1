#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace supple::cli {

/// The options that say how a structure is loaded.
struct LoadArguments {
  std::string uniaxial;      ///< direction, an angle
  std::string frame;         ///< frame of the uniaxial direction: space or material
  std::string biaxial;       ///< direction, an angle
  std::string stretches;     ///< stretches along the direction
  std::string orthogonal;    ///< stretches orthogonal to it, one for each or one for all
  std::string green_strain;  ///< a file, or "xx,yy,xy;xx,yy,xy"
};

void add_load_options(CLI::App& command, LoadArguments& arguments);

/// The load as JSON. Throws Failure(usage) if the options do not describe one, and Failure(local_file).
nlohmann::json load_of(const LoadArguments& arguments);

/// The rows in a file, or in the argument itself if there is no such file, as rows_in gives them. Sets `is_file`.
/// Throws Failure(local_file).
std::vector<std::string> parse_rows(const std::string& argument, bool& is_file);

/// The rows of a text, which end at line breaks and semicolons, without blanks, empty rows and comments ("# ...").
std::vector<std::string> rows_in(std::string text);

/// Green strains: rows xx,yy,xy of a file or of the argument itself. Throws Failure(usage) and Failure(local_file).
nlohmann::json parse_green_strains(const std::string& argument);

}  // namespace supple::cli
