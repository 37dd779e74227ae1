#include "supple/json/weave_requests.h"

#include <Eigen/LU>
#include <algorithm>
#include <string>

#include "weave_reader.h"

namespace supple::json {
namespace {

// The ranges of api/openapi.yaml.
constexpr double min_strain = -0.5;
constexpr double max_strain = 2;
constexpr double max_stretch = 10;
constexpr double max_value = 1e6;
constexpr int max_directions = 10'000;
constexpr int default_directions = 200;
constexpr std::size_t max_places = 20'000;

void read_directions(Fields& fields, std::vector<double>& directions) {
  const auto* value = fields.optional("directions");
  if (value && value->is_array()) {
    fields.array("directions", true, 1, max_directions, "");
    for (std::size_t i = 0; i < value->size(); ++i) {
      directions.push_back(0);
      read_number((*value)[i], fields.at("directions") + "/" + std::to_string(i), fields.faults(), directions.back(),
                  -max_angle, max_angle);
    }
    return;
  }
  int count = default_directions;
  if (value && !value->is_number_integer()) {
    fields.faults().add(fields.at("directions"), "must be a number of directions or an array of angles in radians");
  } else {
    fields.integer("directions", count, 1, max_directions);
  }
  directions = weave::directions_over_half_turn(count);
}

/// Reads indices of some of `count` entries, which messages call `name`.
void read_deformed(Fields& fields, std::size_t count, const std::string& name, std::vector<int>& deformed) {
  const auto* entries = fields.array("deformed", false, 0, max_directions, "");
  if (!entries) return;
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const auto& entry = (*entries)[i];
    const double value = entry.is_number_integer() ? entry.get<double>() : -1;
    if (value < 0 || value >= static_cast<double>(count)) {
      fields.faults().add(fields.at("deformed") + "/" + std::to_string(i),
                          "must be the index of one of the " + std::to_string(count) + " " + name);
    } else {
      deformed.push_back(entry.get<int>());
    }
  }
}

/// Reads matrices of positive determinant, by rows.
void read_gradients(Fields& fields, std::vector<Eigen::Matrix2d>& gradients) {
  const auto* entries = fields.array("deformation_gradients", true, 1, max_directions, "");
  if (!entries) return;
  gradients.reserve(entries->size());
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const auto& rows = (*entries)[i];
    const std::string pointer = fields.at("deformation_gradients") + "/" + std::to_string(i);
    Eigen::Matrix2d& gradient = gradients.emplace_back(Eigen::Matrix2d::Identity());
    if (!rows.is_array() || rows.size() != 2) {
      fields.faults().add(pointer, "must be a 2 x 2 matrix, an array of 2 rows");
      continue;
    }
    bool whole = true;
    for (std::size_t k = 0; k < 2; ++k) {
      Eigen::Vector2d row(0, 0);
      whole &=
          read_components(rows[k], pointer + "/" + std::to_string(k), fields.faults(), row, -max_stretch, max_stretch);
      gradient.row(static_cast<Eigen::Index>(k)) = row;
    }
    if (whole && !(gradient.determinant() > 0)) fields.faults().add(pointer, "must be of positive determinant");
  }
}

/// Reads a place, which must have exactly one of its forms.
PlaceSpec read_place(Fields& fields) {
  const auto* value = fields.required("at");
  if (!value) return {};
  Fields at(*value, fields.at("at"), fields.faults());
  if (!value->is_object()) return {};
  PlaceSpec place;
  const int kinds = at.present("coordinate") + at.present("share") + at.present("crossing") + at.present("box");
  if (kinds != 1) {
    fields.faults().add(fields.at("at"),
                        "must have \"strand\" with \"coordinate\" or \"share\", or \"crossing\", or \"box\"");
    return place;
  }
  const auto read_strand = [&](int& strand) {
    at.required("strand");
    at.integer("strand", strand, 0, max_index);
  };
  if (at.present("coordinate")) {
    StrandCoordinate on_strand;
    read_strand(on_strand.strand);
    at.number("coordinate", on_strand.coordinate, 0, max_length);
    place = on_strand;
  } else if (at.present("share")) {
    StrandFraction on_strand;
    read_strand(on_strand.strand);
    at.number("share", on_strand.share, 0, 1);
    place = on_strand;
  } else if (at.present("crossing")) {
    AtCrossing crossing;
    at.integer("crossing", crossing.crossing, 0, max_index);
    place = crossing;
  } else if (const auto* corners = at.array("box", true, 2, 2, "")) {
    InBox box;
    read_components((*corners)[0], at.at("box") + "/0", fields.faults(), box.lower, -max_value, max_value);
    read_components((*corners)[1], at.at("box") + "/1", fields.faults(), box.upper, -max_value, max_value);
    place = box;
  }
  at.finish();
  return place;
}

void read_vector(Fields& fields, std::string_view name, Eigen::Vector3d& out) {
  if (const auto* value = fields.optional(name))
    read_components(*value, fields.at(name), fields.faults(), out, -max_value, max_value);
}

void read_held(Fields& fields, std::array<bool, 3>& held) {
  const auto* value = fields.optional("held");
  if (!value) return;
  const auto is_boolean = [](const Document& entry) { return entry.is_boolean(); };
  if (!value->is_array() || value->size() != 3 || !std::all_of(value->begin(), value->end(), is_boolean))
    return fields.faults().add(fields.at("held"), "must be an array of 3 booleans, for x, y and z");
  for (std::size_t c = 0; c < 3; ++c) held[c] = (*value)[c].get<bool>();
}

WeaveSupportSpec read_support(const Document& value, const std::string& pointer, Faults& faults) {
  WeaveSupportSpec spec;
  Fields fields(value, pointer, faults);
  spec.at = read_place(fields);
  read_held(fields, spec.support.held);
  read_vector(fields, "displacement", spec.support.displacement);
  fields.boolean("clamped", spec.support.clamped);
  read_vector(fields, "rotation", spec.support.rotation);
  fields.finish();
  return spec;
}

WeaveForceSpec read_force(const Document& value, const std::string& pointer, Faults& faults) {
  WeaveForceSpec spec;
  Fields fields(value, pointer, faults);
  spec.at = read_place(fields);
  fields.required("force");
  read_vector(fields, "force", spec.force);
  fields.finish();
  return spec;
}

template <class Spec>
void read_each(Fields& fields, std::string_view name, bool is_required, std::vector<Spec>& out,
               Spec (*read)(const Document&, const std::string&, Faults&)) {
  const auto* entries = fields.array(name, is_required, is_required ? 1 : 0, max_places, "");
  if (!entries) return;
  out.reserve(entries->size());
  for (std::size_t i = 0; i < entries->size(); ++i)
    out.push_back(read((*entries)[i], fields.at(name) + "/" + std::to_string(i), fields.faults()));
}

}  // namespace

WeaveLayoutRequest parse_weave_layout(std::string_view body, const Limits& limits,
                                      const CancellationToken& cancellation) {
  return read_request<WeaveLayoutRequest>(body, limits, cancellation, [&](Fields& fields, WeaveLayoutRequest& request) {
    request.weave = read_weave(fields, limits);
    fields.boolean("svg", request.svg);
  });
}

WeaveHomogenizationRequest parse_weave_homogenization(std::string_view body, const Limits& limits,
                                                      const CancellationToken& cancellation) {
  return read_request<WeaveHomogenizationRequest>(
      body, limits, cancellation, [&](Fields& fields, WeaveHomogenizationRequest& request) {
        request.weave = read_weave(fields, limits);
        auto& options = request.options;
        fields.number("strain", options.strain, min_strain, max_strain);
        if (options.strain == 0) fields.faults().add(fields.at("strain"), "must not be 0");
        read_directions(fields, options.directions);
        fields.choice("shear", options.shear_free, names_of<bool>({{true, "free"}, {false, "suppressed"}}));
        if (fields.present("thickness")) fields.number("thickness", options.thickness.emplace(1), 0, max_value, true);
        fields.optional("thickness");
        read_deformed(fields, options.directions.size(), "directions", options.deformed);
        read_equilibrium_options(fields, options.equilibrium);
      });
}

WeaveDeformationRequest parse_weave_deformation(std::string_view body, const Limits& limits,
                                                const CancellationToken& cancellation) {
  return read_request<WeaveDeformationRequest>(
      body, limits, cancellation, [&](Fields& fields, WeaveDeformationRequest& request) {
        request.weave = read_weave(fields, limits);
        read_gradients(fields, request.gradients);
        read_deformed(fields, request.gradients.size(), "deformation gradients", request.deformed);
        read_equilibrium_options(fields, request.options);
      });
}

WeaveSimulationRequest parse_weave_simulation(std::string_view body, const Limits& limits,
                                              const CancellationToken& cancellation) {
  return read_request<WeaveSimulationRequest>(
      body, limits, cancellation, [&](Fields& fields, WeaveSimulationRequest& request) {
        request.weave = read_weave(fields, limits);
        read_each(fields, "supports", true, request.supports, read_support);
        read_each(fields, "forces", false, request.forces, read_force);
        fields.integer("states", request.states, 1, static_cast<int>(limits.max_states));
        fields.choice("deformed", request.deformed, deformed_strands_names);
        read_equilibrium_options(fields, request.options);
      });
}

}  // namespace supple::json
