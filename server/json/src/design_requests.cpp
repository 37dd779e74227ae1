#include "supple/json/design_requests.h"

#include <limits>
#include <numbers>

#include "request_parts.h"
#include "supple/json/structure_requests.h"

namespace supple::json {
namespace {

// The ranges of api/openapi.yaml.
constexpr double max_design_parameter = 1000;
constexpr double max_value = design::largest_coordinate;
constexpr double min_strain = -0.5;
constexpr double max_profile_strain = 7.5;
constexpr std::size_t max_control_points = 64;
constexpr std::size_t max_further_targets = 8;
constexpr std::size_t max_regions = 20;
constexpr int max_target_samples = 500;
constexpr int max_profile_samples = 1000;
constexpr std::size_t max_name_bytes = 100;
constexpr int default_strains = 31;
constexpr int default_directions = 50;
constexpr double min_modulus = 1e-6;
constexpr double max_modulus = 1e6;
constexpr double max_density = 25;
constexpr std::size_t max_materials = 16;
constexpr double min_cell_size = 0.01;
constexpr double max_cell_size = 2000;
constexpr double default_range[2] = {-0.1, 0.2};

void read_text(Fields& fields, std::string_view name, std::string& out, std::size_t max_bytes) {
  const auto* value = fields.optional(name);
  if (!value) return;
  if (!value->is_string() || value->get_ref<const std::string&>().size() > max_bytes) {
    return fields.faults().add(fields.at(name), "must be a string of at most " + std::to_string(max_bytes) + " bytes");
  }
  out = value->get<std::string>();
}

void read_session(Fields& fields, std::string& out) {
  const auto* value = fields.optional("session");
  if (!value) return;
  constexpr std::size_t max_bytes = 64;
  if (value->is_string()) out = value->get<std::string>();
  const auto allowed = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  if (out.empty() || out.size() > max_bytes || !std::all_of(out.begin(), out.end(), allowed)) {
    fields.faults().add(fields.at("session"), "must be 1 to 64 letters, digits, \"_\" or \"-\"");
  }
}

void read_parameters(Fields& fields, std::string_view name, std::vector<double>& out) {
  const auto* entries = fields.array(name, false, 1, neural::max_parameters, "");
  if (!entries) return;
  out.resize(entries->size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    read_number((*entries)[k], fields.at(name) + "/" + std::to_string(k), fields.faults(), out[k],
                -max_design_parameter, max_design_parameter);
  }
}

void read_fixed(Fields& fields, std::vector<std::optional<double>>& out) {
  const auto* entries = fields.array("fixed", false, 1, neural::max_parameters, "");
  if (!entries) return;
  for (std::size_t k = 0; k < entries->size(); ++k) {
    const auto& entry = (*entries)[k];
    double value = 0;
    out.emplace_back();
    if (entry.is_null()) continue;
    if (read_number(entry, fields.at("fixed") + "/" + std::to_string(k), fields.faults(), value, -max_design_parameter,
                    max_design_parameter)) {
      out.back() = value;
    }
  }
}

/// Reads weights or bands.
void read_list(Fields& fields, std::string_view name, std::vector<double>& out) {
  const auto* entries = fields.array(name, false, 2, max_control_points, "");
  if (!entries) return;
  out.resize(entries->size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    read_number((*entries)[i], fields.at(name) + "/" + std::to_string(i), fields.faults(), out[i], 0, max_value);
  }
}

void read_spline(Fields& fields, design::Target& target) {
  const auto* value = fields.required("target");
  if (!value) return;
  Fields spline(*value, fields.at("target"), fields.faults());
  if (const auto* points = spline.array("control_points", true, 2, max_control_points, "")) {
    for (std::size_t i = 0; i < points->size(); ++i) {
      Eigen::Vector2d point = Eigen::Vector2d::Zero();
      read_components((*points)[i], spline.at("control_points") + "/" + std::to_string(i), fields.faults(), point,
                      -max_value, max_value);
      target.control_points.push_back(point);
    }
  }
  spline.choice("interpolation", target.interpolation, interpolation_names);
  read_list(spline, "weights", target.weights);
  read_list(spline, "bands", target.bands);
  spline.finish();
}

/// What targets and profiles have in common.
template <class Samples>
void read_samples(Fields& fields, Samples& out, design::StrainMeasure& measure) {
  fields.required("task");
  fields.choice("task", out.task, task_names);
  fields.number("direction", out.direction, -max_angle, max_angle);
  fields.number("strain", out.strain, min_strain, max_profile_strain, true);
  fields.choice("strain_measure", measure, strain_measure_names);
}

/// Reads a pair of numbers within [min, max], the lesser first.
void read_range(const Document& value, const std::string& pointer, Faults& faults, design::Range& out, double min,
                double max) {
  Eigen::Vector2d range(out.least, out.most);
  if (!read_components(value, pointer, faults, range, min, max)) return;
  if (!(range[0] <= range[1])) return faults.add(pointer, "must begin with the lesser of its numbers");
  out = {range[0], range[1]};
}

/// Reads a number, or a range where `may_be_range`.
void read_modulus(Fields& fields, bool may_be_range, MaterialSpec& out) {
  const auto* value = fields.optional("youngs_modulus");
  if (!value) return;
  const auto pointer = fields.at("youngs_modulus");
  if (may_be_range && value->is_array()) {
    read_range(*value, pointer, fields.faults(), out.youngs_modulus, min_modulus, max_modulus);
  } else {
    double modulus = 1;
    read_number(*value, pointer, fields.faults(), modulus, min_modulus, max_modulus);
    out.youngs_modulus = {modulus, modulus};
  }
  out.has_modulus = true;
}

/// Reads a number, or a pair between which the orientation is found.
void read_orientation(Fields& fields, design::DesignProblem& problem) {
  const auto* value = fields.optional("orientation");
  if (value && value->is_array()) {
    read_range(*value, fields.at("orientation"), fields.faults(), problem.orientation, -max_angle, max_angle);
  } else if (value) {
    double orientation = 0;
    read_number(*value, fields.at("orientation"), fields.faults(), orientation, -max_angle, max_angle);
    problem.orientation = {orientation, orientation};
  }
  const auto& [min, max] = problem.orientation;
  if (max - min > std::numbers::pi * (1 + 1e-9))
    fields.faults().add(fields.at("orientation"), "must span at most half a turn, pi: responses repeat after it");
  if (!fields.present("initial_orientation")) return;
  double initial = min;
  fields.number("initial_orientation", initial, -max_angle, max_angle);
  if (!fields.present("initial")) {
    fields.faults().add(fields.at("initial_orientation"), "needs \"initial\", whose orientation it is");
  } else if (initial < min || initial > max) {
    fields.faults().add(fields.at("initial_orientation"), "must be within the orientations that are open, " +
                                                              std::to_string(min) + " to " + std::to_string(max));
  } else {
    problem.initial_orientation = initial;
  }
}

MaterialSpec read_material(const Document& value, const std::string& pointer, Faults& faults, bool may_be_range) {
  MaterialSpec material;
  Fields fields(value, pointer, faults);
  read_text(fields, "name", material.name, max_name_bytes);
  read_modulus(fields, may_be_range, material);
  auto law = microscale::Law::neo_hookean;
  fields.choice("law", law, law_names);
  material.is_neo_hookean = law == microscale::Law::neo_hookean;
  double poisson_ratio = 0;
  if (fields.present("poisson_ratio")) {
    fields.number("poisson_ratio", poisson_ratio, -0.99, 0.499);
    material.poisson_ratio = poisson_ratio;
  }
  fields.number("density", material.density, 0, max_density, true);
  fields.finish();
  return material;
}

/// Reads one material, or a list of those that the search may choose from.
void read_materials(Fields& fields, RegionSpec& region) {
  const auto* value = fields.optional("material");
  if (!value) return;
  const auto pointer = fields.at("material");
  if (!value->is_array()) {
    region.materials.push_back(read_material(*value, pointer, fields.faults(), true));
    region.materials.back().where = "material";
    return;
  }
  if (value->empty() || value->size() > max_materials) {
    return fields.faults().add(pointer, "must have 1 to " + std::to_string(max_materials) + " materials");
  }
  for (std::size_t i = 0; i < value->size(); ++i) {
    const auto place = pointer + "/" + std::to_string(i);
    region.materials.push_back(read_material((*value)[i], place, fields.faults(), true));
    region.materials.back().where = "material/" + std::to_string(i);
    if (value->size() > 1 && !region.materials.back().has_modulus)
      fields.faults().add(place, "must have \"youngs_modulus\", since there are several to choose from");
  }
}

/// Reads the size of the structure and its limits. The engine measures cells in widths of a beam.
void read_size(Fields& fields, RegionSpec& region) {
  const bool by_cells = fields.present("cell_size");
  if (by_cells && fields.present("beam_width")) {
    fields.faults().add(fields.at("cell_size"), "must not stand beside \"beam_width\": one follows from the other");
  }
  fields.number("beam_width", region.beam_width, min_beam_width, max_beam_width);
  if (by_cells) {
    region.cell_size = 1;
    fields.number("cell_size", region.cell_size, min_cell_size, max_cell_size);
  }
  nested(fields, "limits", [&](Fields& limits) {
    const auto read = [&](std::string_view name, design::Range& out, double min, double max) {
      const auto* value = limits.optional(name);
      if (value) read_range(*value, limits.at(name), limits.faults(), out, min, max);
      return value != nullptr;
    };
    auto& out = region.problem.limits;
    read("relative_density", out.relative_density, 0, 1);
    design::Range range;
    if (read("cell_size", range, 0, max_cell_size)) {
      if (by_cells) limits.faults().add(limits.at("cell_size"), "is given already by the field \"cell_size\"");
      out.cell_size = {range.least / region.beam_width, range.most / region.beam_width};
    }
    range = {min_beam_width, max_beam_width};
    if (read("beam_width", range, min_beam_width, max_beam_width)) {
      if (!by_cells) {
        limits.faults().add(limits.at("beam_width"),
                            "needs the field \"cell_size\": without it all beams have the width that is given");
      }
      out.cell_size = {region.cell_size / range.most, region.cell_size / range.least};
    }
  });
}

design::Target read_target(Fields& fields) {
  design::Target target;
  read_samples(fields, target, target.measure);
  read_spline(fields, target);
  if (fields.present("samples")) fields.integer("samples", target.samples, 2, max_target_samples);
  fields.number("weight", target.weight, 0, max_value, true);
  return target;
}

RegionSpec read_region(Fields& fields) {
  RegionSpec region;
  read_text(fields, "name", region.name, max_name_bytes);
  region.problem.targets.push_back(read_target(fields));
  if (const auto* further = fields.array("also", false, 0, max_further_targets, "")) {
    for (std::size_t i = 0; i < further->size(); ++i) {
      Fields inner((*further)[i], fields.at("also") + "/" + std::to_string(i), fields.faults());
      region.problem.targets.push_back(read_target(inner));
      inner.finish();
    }
  }
  read_text(fields, "family", region.family, max_name_bytes);
  read_text(fields, "model", region.model, max_name_bytes);
  if (fields.present("family") && fields.present("model")) {
    fields.faults().add(fields.at("model"), "must not stand beside \"family\"");
  }
  std::vector<double> initial;
  read_parameters(fields, "initial", initial);
  if (!initial.empty()) {
    region.problem.initial =
        Eigen::Map<const Eigen::VectorXd>(initial.data(), static_cast<Eigen::Index>(initial.size()));
  }
  read_fixed(fields, region.problem.fixed);
  read_orientation(fields, region.problem);
  read_materials(fields, region);
  read_size(fields, region);
  return region;
}

void read_options(Fields& fields, DesignRequest& request) {
  nested(fields, "accuracy", [&](Fields& accuracy) {
    auto& options = request.options;
    accuracy.number("tolerance", options.tolerance, 1e-12, 1e-2);
    accuracy.number("equilibrium_tolerance", options.equilibrium_tolerance, 1e-14, 1e-4);
    accuracy.integer("max_iterations", options.max_iterations, 1, 1000);
    accuracy.integer("starts", options.starts, 1, 64);
    if (accuracy.present("candidates")) accuracy.integer("candidates", options.candidates, 1, 4096);
    auto& polish = request.verification.options;
    accuracy.integer("verified_samples", polish.samples, 2, 200);
    accuracy.number("polish_tolerance", polish.tolerance, 1e-4, 0.5);
    accuracy.integer("polish_rounds", polish.max_rounds, 1, 200);
    accuracy.number("polish_seconds", polish.max_seconds, 0.1, 3600);
  });
  nested(fields, "effects", [&](Fields& effects) {
    effects.choice("multi_start", request.options.multi_start, switch_names);
    effects.choice("trust", request.options.trust, switch_names);
    effects.choice("envelope", request.options.envelope, switch_names);
    effects.choice("polish", request.verification.polish, switch_names);
    effects.choice("ways_out", request.ways_out, switch_names);
    effects.choice("beam_width_sensitivity", request.beam_width_sensitivity, switch_names);
  });
}

}  // namespace

DesignRequest parse_design(std::string_view body, const Limits& limits, const CancellationToken& cancellation) {
  return read_request<DesignRequest>(body, limits, cancellation, [&](Fields& fields, DesignRequest& request) {
    request.several = fields.present("regions");
    if (request.several) {
      if (const auto* regions = fields.array("regions", true, 1, max_regions, "")) {
        for (std::size_t i = 0; i < regions->size(); ++i) {
          Fields inner((*regions)[i], fields.at("regions") + "/" + std::to_string(i), fields.faults());
          request.regions.push_back(read_region(inner));
          inner.finish();
        }
      }
    } else {
      request.regions.push_back(read_region(fields));
    }
    fields.boolean("verify", request.verify);
    read_options(fields, request);
    request.verification.options.equilibrium_tolerance = request.options.equilibrium_tolerance;
    read_session(fields, request.session);
  });
}

ProfileRequest parse_profile(std::string_view body, const Limits& limits, const CancellationToken& cancellation) {
  return read_request<ProfileRequest>(body, limits, cancellation, [&](Fields& fields, ProfileRequest& request) {
    read_samples(fields, request.samples, request.samples.measure);
    read_text(fields, "family", request.family, max_name_bytes);
    read_text(fields, "model", request.model, max_name_bytes);
    if (fields.is_object() && fields.present("family") == fields.present("model")) {
      fields.faults().add("", "must have exactly one of \"family\" and \"model\"");
    }
    fields.required("parameters");
    read_parameters(fields, "parameters", request.parameters);
    const bool over_strain = request.samples.task == design::Task::stress_strain;
    Eigen::Vector2d range(default_range[0], default_range[1]);
    int samples = over_strain ? default_strains : default_directions;
    if (const auto* value = fields.optional("range")) {
      read_components(*value, fields.at("range"), fields.faults(), range, -max_angle, max_angle);
      if (!over_strain)
        fields.faults().add(fields.at("range"), "directions cover half a turn; leave it out or give \"x\"");
    }
    fields.integer("samples", samples, 2, max_profile_samples);
    fields.numbers("x", request.samples.x, false, 1, max_profile_samples);
    if (fields.present("x") && (fields.present("range") || fields.present("samples"))) {
      fields.faults().add(fields.at("x"), "must not stand beside \"range\" or \"samples\"");
    }
    if (!fields.present("x")) {
      request.samples.x.resize(static_cast<std::size_t>(samples));
      for (int i = 0; i < samples; ++i) {
        request.samples.x[static_cast<std::size_t>(i)] =
            over_strain ? range[0] + (range[1] - range[0]) * i / (samples - 1) : std::numbers::pi * i / samples;
      }
    }
    fields.number("orientation", request.samples.orientation, -max_angle, max_angle);
    if (const auto* material = fields.optional("material"))
      request.material = read_material(*material, fields.at("material"), fields.faults(), false);
    nested(fields, "accuracy", [&](Fields& accuracy) {
      accuracy.number("equilibrium_tolerance", request.equilibrium_tolerance, 1e-14, 1e-4);
    });
  });
}

}  // namespace supple::json
