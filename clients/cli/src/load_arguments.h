#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// The options that say how a structure is loaded.
struct LoadArguments {
  std::string uniaxial;      ///< direction in rad
  std::string biaxial;       ///< direction in rad
  std::string stretches;     ///< along the direction
  std::string orthogonal;    ///< stretches orthogonal to it, or one for all
  std::string green_strain;  ///< a file, or "xx,yy,xy;xx,yy,xy"
};

void add_load_options(CLI::App& command, LoadArguments& arguments);

/// The load as the wire has it. Throws Failure(usage) where the options do not say one, Failure(local_file).
nlohmann::json load_of(const LoadArguments& arguments);

}  // namespace supple::cli
