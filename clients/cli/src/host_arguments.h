#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace supple::cli {

/// The options that say what carries a network and how it gives way.
struct HostArguments {
  std::string kind;  ///< rigid, shell, solid or moving; empty: as the file of the network says, else rigid
  double thickness = 0;
  double youngs_modulus = 0;
  double poisson_ratio = -2;
  double volume_weight = -1;
  double volume_scale = 0;
  double element_size = 0;
  std::string gravity;                 ///< "x,y,z"
  std::vector<std::string> regions;    ///< "x0,y0,z0,x1,y1,z1,E"
  std::vector<std::string> vertices;   ///< that stay where they are: "0" or "0,4,7"
  std::vector<std::string> moves;      ///< of vertices: "I,X,Y,Z[,X,Y,Z...]"
  std::vector<std::string> positions;  ///< of a moving surface: files with a place for each vertex
  bool no_bending = false;
};

void add_host_options(CLI::App& command, HostArguments& arguments);

/// Sets what a request says of its host; options count before what the request has already. Throws Failure(usage) where
/// an option is not of the host's kind, where it lacks one, or where its numbers are none.
void set_host(const HostArguments& arguments, nlohmann::json& request);

/// Prints what became of the host, if the answer has one, and what the energy consists of.
void print_host(const nlohmann::json& answer);
void print_terms(const nlohmann::json& answer);

}  // namespace supple::cli
