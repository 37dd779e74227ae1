#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// The options that simulations of structures and of parts have in common. Empty texts and 0 leave a field out.
struct SolverArguments {
  std::string law;
  double youngs_modulus = 0;
  std::string poisson_ratio;
  double mesh_size = 0;
  double corner_size = 0;
  double tolerance = 0;
  double max_load_step = 0;
  std::string contact;
  std::string buckling;
  double deadline = 0;
};

/// Adds the options of the material.
void add_material_options(CLI::App& command, SolverArguments& arguments);
/// Adds the options of the mesh.
void add_mesh_options(CLI::App& command, SolverArguments& arguments);
/// Adds the other options. `tolerance` names that of the residual, and `load_step` says what a step changes.
void add_path_options(CLI::App& command, SolverArguments& arguments, const char* tolerance, const char* load_step);

/// Sets a member of an object of the request, such as "accuracy", if the value is given.
void set_member(nlohmann::json& request, const char* group, const char* name, const std::string& value);
void set_member(nlohmann::json& request, const char* group, const char* name, double value);

/// Sets "material", "accuracy", "effects" and "deadline". Throws Failure(usage).
void set_solver_fields(const SolverArguments& arguments, nlohmann::json& request);

/// The check of an option that is automatic, on or off.
CLI::Validator switch_values();

}  // namespace supple::cli
