#include "solver_arguments.h"

#include "numbers.h"
#include "units.h"

namespace supple::cli {

CLI::Validator switch_values() { return CLI::IsMember({"automatic", "on", "off"}); }

void add_material_options(CLI::App& command, SolverArguments& arguments) {
  command.add_option("--law", arguments.law, "Material (neo_hookean)")
      ->check(CLI::IsMember({"neo_hookean", "incompressible_plane_stress"}));
  command.add_option("--youngs-modulus", arguments.youngs_modulus, "Young's modulus in MPa (26)")
      ->transform(quantity(Dimension::stress))
      ->check(CLI::PositiveNumber);
  command.add_option("--poisson-ratio", arguments.poisson_ratio, "Poisson's ratio (0.48)")->check(CLI::Number);
}

void add_mesh_options(CLI::App& command, SolverArguments& arguments) {
  command
      .add_option("--mesh-size", arguments.mesh_size,
                  "Sides of the triangles as a share of the beam width; states are then those of this mesh")
      ->check(CLI::PositiveNumber);
  command.add_option("--corner-size", arguments.corner_size, "Sides at re-entrant corners as a share of the others")
      ->check(CLI::PositiveNumber);
}

void add_path_options(CLI::App& command, SolverArguments& arguments, const char* tolerance, const char* load_step) {
  command.add_option(tolerance, arguments.tolerance, "Relative residual of an equilibrium (1e-8)")
      ->check(CLI::PositiveNumber);
  command.add_option("--max-load-step", arguments.max_load_step, load_step)->check(CLI::PositiveNumber);
  command.add_option("--contact", arguments.contact, "Self-contact (automatic)")->check(switch_values());
  command.add_option("--buckling", arguments.buckling, "Leave unstable states (automatic)")->check(switch_values());
  command.add_option("--deadline", arguments.deadline, "Seconds that the computation may take, or for example 2min")
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
}

void set_member(nlohmann::json& request, const char* group, const char* name, const std::string& value) {
  if (!value.empty()) request[group][name] = value;
}

void set_member(nlohmann::json& request, const char* group, const char* name, double value) {
  if (value > 0) request[group][name] = value;
}

void set_solver_fields(const SolverArguments& arguments, nlohmann::json& request) {
  set_member(request, "material", "law", arguments.law);
  set_member(request, "material", "youngs_modulus", arguments.youngs_modulus);
  if (!arguments.poisson_ratio.empty())
    request["material"]["poisson_ratio"] = parse_numbers(arguments.poisson_ratio, "Poisson's ratio").front();
  set_member(request, "accuracy", "mesh_size", arguments.mesh_size);
  set_member(request, "accuracy", "corner_size", arguments.corner_size);
  set_member(request, "accuracy", "tolerance", arguments.tolerance);
  set_member(request, "accuracy", "max_load_step", arguments.max_load_step);
  set_member(request, "effects", "contact", arguments.contact);
  set_member(request, "effects", "buckling", arguments.buckling);
  if (arguments.deadline > 0) request["deadline"] = arguments.deadline;
}

}  // namespace supple::cli
