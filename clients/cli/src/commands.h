#pragma once

#include <CLI/App.hpp>
#include <string>

#include "session.h"

namespace supple::cli {

// Each function adds one family of commands to the program. `options` is read when a command runs, after parsing.

void add_mesh_commands(CLI::App& program, const GlobalOptions& options);
void add_geodesic_command(CLI::App& program, const GlobalOptions& options);
void add_field_command(CLI::App& program, const GlobalOptions& options);
void add_karcher_command(CLI::App& program, const GlobalOptions& options);
void add_relax_command(CLI::App& program, const GlobalOptions& options);
void add_voronoi_command(CLI::App& program, const GlobalOptions& options);
void add_exponential_map_command(CLI::App& program, const GlobalOptions& options);
void add_family_command(CLI::App& program, const GlobalOptions& options);
void add_structure_command(CLI::App& program, const GlobalOptions& options);
void add_simulate_command(CLI::App& program, const GlobalOptions& options);
void add_model_commands(CLI::App& program, const GlobalOptions& options);
void add_evaluate_command(CLI::App& program, const GlobalOptions& options);
void add_uniaxial_command(CLI::App& program, const GlobalOptions& options);
void add_curve_command(CLI::App& program, const GlobalOptions& options);
void add_outlines_command(CLI::App& program, const GlobalOptions& options);
void add_part_command(CLI::App& program, const GlobalOptions& options);
void add_design_command(CLI::App& program, const GlobalOptions& options);
void add_profile_command(CLI::App& program, const GlobalOptions& options);
void add_weave_commands(CLI::App& program, const GlobalOptions& options);
void add_job_commands(CLI::App& program, const GlobalOptions& options);

/// Adds `completion` and `man`, which describe the program itself and need no server.
void add_program_commands(CLI::App& program, const std::string& version);

}  // namespace supple::cli
