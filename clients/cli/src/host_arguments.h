#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace supple::cli {

/// The options that describe the host of a network.
struct HostArguments {
  std::string kind;  ///< rigid, shell, solid or moving; empty: the kind in the network's file, else rigid
  double thickness = 0;
  double youngs_modulus = 0;
  double poisson_ratio = -2;
  double volume_weight = -1;
  double volume_scale = 0;
  double element_size = 0;
  std::string gravity;                      ///< "x,y,z"
  std::vector<std::string> regions;         ///< "x0,y0,z0,x1,y1,z1,E"
  std::vector<std::string> fixed_vertices;  ///< fixed vertices: "0" or "0,4,7"
  std::vector<std::string> moved_vertices;  ///< moved vertices: "I,X,Y,Z[,X,Y,Z...]"
  std::vector<std::string> positions;       ///< files with the position of each vertex of a moving surface
  bool no_bending = false;
};

void add_host_options(CLI::App& command, HostArguments& arguments);

/// Sets the host of a request; options replace fields that the request has already. Throws Failure(usage) if an option
/// does not belong to the host's kind, if the kind requires an option that is missing, or if numbers are malformed.
void set_host(const HostArguments& arguments, nlohmann::json& request);

/// Prints the state of the host, if the answer has one, and the terms of the energy.
void print_host(const nlohmann::json& answer);
void print_terms(const nlohmann::json& answer);

}  // namespace supple::cli
