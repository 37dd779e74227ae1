#include "supple/json/structure_requests.h"

#include <algorithm>

#include "family_fields.h"
#include "request_parts.h"
#include "simulation_fields.h"
#include "supple/microscale/accurate_simulation.h"

namespace supple::json {
namespace {

// The ranges of api/openapi.yaml.
constexpr double min_mesh_size = 0.01;
constexpr double max_mesh_size = 2;
constexpr double min_corner_size = 0.01;
constexpr double min_accepted_error = 2e-4;
constexpr double max_accepted_error = 0.1;
constexpr int max_cells = 100;
constexpr double min_height = 1e-3;
constexpr double max_height = 1000;

bool is_family_character(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

void read_mesh_options(Fields& fields, tiling::MeshOptions& mesh) {
  read_mesh_sizes(fields, mesh);
  fields.choice("mesh_region", mesh.region, region_names);
}

tiling::MeshOptions with_limit(tiling::MeshOptions mesh, int max_nodes) {
  mesh.max_nodes = max_nodes;
  return mesh;
}

void read_cells(Fields& fields, tiling::ExportOptions& files) {
  const auto* cells = fields.optional("cells");
  if (!cells) return;
  const auto is_count = [](const Document& entry) {
    return entry.is_number_integer() && entry.get<double>() >= 1 && entry.get<double>() <= max_cells;
  };
  if (!cells->is_array() || cells->size() != 2 || !std::all_of(cells->begin(), cells->end(), is_count)) {
    return fields.faults().add(fields.at("cells"),
                               "must be an array of 2 integers from 1 to " + std::to_string(max_cells));
  }
  files.first = (*cells)[0].get<int>();
  files.second = (*cells)[1].get<int>();
}

/// Reads the states of a load; read(entry, pointer, state) returns whether an entry is valid.
template <class State, class Read>
void read_states(Fields& fields, std::string_view name, const Limits& limits, std::vector<State>& states, Read read) {
  const auto* entries = fields.array(name, true, 1, limits.max_states, "--max-states");
  if (!entries) return;
  states.reserve(entries->size());
  for (std::size_t i = 0; i < entries->size(); ++i) {
    State state{};
    if (read((*entries)[i], fields.at(name) + "/" + std::to_string(i), state)) states.push_back(state);
  }
}

microscale::GreenStrainLoad read_green_strain(Fields& load, const Limits& limits) {
  microscale::GreenStrainLoad strain;
  read_states(load, "green_strain", limits, strain.strains, [&](const auto& entry, const auto& pointer, auto& state) {
    return read_components(entry, pointer, load.faults(), state, -max_dimensionless, max_dimensionless);
  });
  return strain;
}

void read_direction(Fields& fields, double& direction) {
  fields.required("direction");
  fields.number("direction", direction, -max_angle, max_angle);
}

microscale::UniaxialLoad read_uniaxial(Fields& fields, const Limits& limits) {
  microscale::UniaxialLoad load;
  read_direction(fields, load.direction);
  read_states(fields, "stretches", limits, load.stretches, [&](const auto& entry, const auto& pointer, auto& state) {
    return read_number(entry, pointer, fields.faults(), state, min_stretch, max_stretch);
  });
  fields.choice("frame", load.frame, load_frame_names);
  return load;
}

microscale::BiaxialLoad read_biaxial(Fields& fields, const Limits& limits) {
  microscale::BiaxialLoad load;
  read_direction(fields, load.direction);
  read_states(fields, "stretches", limits, load.stretches, [&](const auto& entry, const auto& pointer, auto& state) {
    return read_components(entry, pointer, fields.faults(), state, min_stretch, max_stretch);
  });
  return load;
}

void read_load(Fields& fields, microscale::Load& out, const Limits& limits) {
  const auto* value = fields.required("load");
  if (!value) return;
  Fields load(*value, fields.at("load"), fields.faults());
  if (!value->is_object()) return;
  const int kinds = load.present("green_strain") + load.present("uniaxial") + load.present("biaxial");
  if (kinds != 1) {
    fields.faults().add(fields.at("load"), "must have exactly one of \"green_strain\", \"uniaxial\" and \"biaxial\"");
  }
  if (load.present("green_strain")) out = read_green_strain(load, limits);
  nested(load, "uniaxial", [&](Fields& kind) { out = read_uniaxial(kind, limits); });
  nested(load, "biaxial", [&](Fields& kind) { out = read_biaxial(kind, limits); });
  load.finish();
}

/// What the request says of the mesh's error.
struct ErrorRequest {
  bool mesh_given = false;
  std::optional<double> accepted;
  microscale::Switch refinement = microscale::Switch::automatic;
};

/// Decides whether the mesh is the request's or the server's, and what is done about its error.
void choose_refinement(const ErrorRequest& asked, Faults& faults, SimulationRequest& request) {
  using microscale::Refinement;
  using microscale::Switch;
  Refinement& refinement = request.options.refinement;
  if (asked.refinement == Switch::off) {
    refinement = Refinement::off;
    if (asked.accepted) {
      faults.add("/accuracy/discretization_error",
                 "cannot be had with effects.refinement \"off\", which leaves the error unknown");
    }
  } else if (asked.refinement == Switch::on || !asked.mesh_given) {
    refinement = Refinement::extrapolated;
  } else {
    refinement = Refinement::estimated;
  }
  request.accepted_error = asked.accepted;
  request.mesh_given = asked.mesh_given;
}

void read_options(Fields& fields, SimulationRequest& request) {
  microscale::SimulationOptions& options = request.options;
  ErrorRequest asked;
  read_material(fields, options.material);
  nested(fields, "accuracy", [&](Fields& accuracy) {
    asked.mesh_given = accuracy.present("mesh_size");
    if (asked.mesh_given) options.mesh = with_limit({}, options.mesh.max_nodes);
    read_mesh_options(accuracy, options.mesh);
    if (accuracy.present("discretization_error")) {
      asked.accepted.emplace();
      accuracy.number("discretization_error", *asked.accepted, min_accepted_error, max_accepted_error);
    }
    read_path_accuracy(accuracy, options);
  });
  nested(fields, "effects", [&](Fields& effects) {
    effects.choice("contact", options.contact, switch_names);
    effects.choice("patch", options.patch, switch_names);
    effects.choice("buckling", options.buckling, switch_names);
    effects.choice("refinement", asked.refinement, switch_names);
  });
  fields.boolean("tangents", options.tangents);
  choose_refinement(asked, fields.faults(), request);
}

}  // namespace

void read_material(Fields& fields, microscale::Material& material) {
  nested(fields, "material", [&](Fields& members) {
    members.choice("law", material.law, law_names);
    members.number("youngs_modulus", material.youngs_modulus, 1e-6, 1e6);
    members.number("poisson_ratio", material.poisson_ratio, -0.99, 0.499);
  });
}

void read_mesh_sizes(Fields& fields, tiling::MeshOptions& mesh) {
  fields.number("mesh_size", mesh.mesh_size, min_mesh_size, max_mesh_size);
  fields.number("corner_size", mesh.corner_size, min_corner_size, 1);
}

void read_family_id(Fields& fields, std::string_view name, std::string& out) {
  const auto* value = fields.required(name);
  if (!value) return;
  const auto* text = value->is_string() ? &value->get_ref<const std::string&>() : nullptr;
  if (!text || text->empty() || text->size() > 32 || !std::all_of(text->begin(), text->end(), is_family_character)) {
    return fields.faults().add(fields.at(name), "must be a family's id, for example \"IH21\"");
  }
  out = *text;
}

StructureSpec read_structure(Fields& fields, const Limits& limits) {
  StructureSpec structure;
  read_family_id(fields, "family", structure.family);
  if (fields.present("parameters")) {
    structure.parameters.emplace();
    fields.numbers("parameters", *structure.parameters, false, 0, limits.max_parameters);
  } else {
    fields.optional("parameters");
  }
  return structure;
}

StructureRequest parse_structure(std::string_view body, const Limits& limits, const CancellationToken& cancellation) {
  return read_request<StructureRequest>(body, limits, cancellation, [&](Fields& fields, StructureRequest& request) {
    request.structure = read_structure(fields, limits);
    fields.number("beam_width", request.beam_width, min_beam_width, max_beam_width);
    read_cells(fields, request.files);
    fields.number("height", request.files.height, min_height, max_height);
    nested(fields, "mesh", [&](Fields& mesh) {
      request.mesh.emplace().max_nodes = limits.max_mesh_nodes;
      read_mesh_options(mesh, *request.mesh);
    });
    fields.boolean("svg", request.svg);
  });
}

SimulationRequest parse_simulation(std::string_view body, const Limits& limits, const CancellationToken& cancellation) {
  return read_request<SimulationRequest>(body, limits, cancellation, [&](Fields& fields, SimulationRequest& request) {
    request.structure = read_structure(fields, limits);
    read_load(fields, request.load, limits);
    request.options.mesh = with_limit(microscale::extrapolated_mesh(), limits.max_mesh_nodes);
    read_options(fields, request);
    fields.choice("deformed", request.deformed, deformed_names);
    request.options.deformed_meshes = request.deformed != Deformed::none;
  });
}

}  // namespace supple::json
