#include "supple/json/model_requests.h"

#include "request_parts.h"

namespace supple::json {
namespace {

// The ranges of api/openapi.yaml.
constexpr double max_parameter = 1000;
constexpr double max_strain = 100;
constexpr double min_uniaxial_strain = -0.5;
constexpr double max_uniaxial_strain = 7.5;
constexpr double min_tolerance = 1e-14;
constexpr double max_tolerance = 1e-2;
constexpr int max_solver_iterations = 10'000;

/// The parameters of one design.
void read_design(const Document& value, const std::string& pointer, Faults& faults, std::vector<double>& design) {
  constexpr std::size_t max = neural::max_parameters;
  if (!value.is_array() || value.empty() || value.size() > max) {
    return faults.add(pointer, "must be an array of 1 to " + std::to_string(max) + " numbers");
  }
  design.resize(value.size());
  for (std::size_t k = 0; k < design.size(); ++k) {
    read_number(value[k], pointer + "/" + std::to_string(k), faults, design[k], -max_parameter, max_parameter);
  }
}

/// Calls read(entry, pointer, i) for each entry of an array.
template <class Read>
void for_each_entry(Fields& fields, std::string_view name, const Document& entries, Read read) {
  const auto folder = fields.at(name) + "/";
  for (std::size_t i = 0; i < entries.size(); ++i) read(entries[i], folder + std::to_string(i), i);
}

void read_strains(Fields& fields, Eigen::Matrix3Xd& strains, const Limits& limits) {
  const auto* entries = fields.array("green_strain", true, 1, limits.max_strains, "--max-strains");
  if (!entries) return;
  strains.setZero(3, static_cast<Eigen::Index>(entries->size()));
  for_each_entry(fields, "green_strain", *entries, [&](const auto& entry, const auto& pointer, std::size_t i) {
    Eigen::Vector3d strain = Eigen::Vector3d::Zero();
    read_components(entry, pointer, fields.faults(), strain, -max_strain, max_strain);
    strains.col(static_cast<Eigen::Index>(i)) << strain[0], strain[1], 2 * strain[2];
  });
}

void read_designs(Fields& fields, std::vector<std::vector<double>>& designs, const Limits& limits) {
  const auto* entries = fields.array("parameters", true, 1, limits.max_strains, "--max-strains");
  if (!entries) return;
  designs.resize(entries->size());
  for_each_entry(fields, "parameters", *entries, [&](const auto& entry, const auto& pointer, std::size_t i) {
    read_design(entry, pointer, fields.faults(), designs[i]);
  });
}

void read_path(Fields& fields, std::string_view name, const Limits& limits, std::vector<double>& states, double min,
               double max, bool min_excluded) {
  const auto* entries = fields.array(name, false, 1, limits.max_states, "--max-states");
  if (!entries) return;
  states.resize(entries->size());
  for_each_entry(fields, name, *entries, [&](const auto& entry, const auto& pointer, std::size_t i) {
    read_number(entry, pointer, fields.faults(), states[i], min, max, min_excluded);
  });
}

}  // namespace

EvaluationRequest parse_evaluation(std::string_view body, const Limits& limits, const CancellationToken& cancellation) {
  return read_request<EvaluationRequest>(body, limits, cancellation, [&](Fields& fields, EvaluationRequest& request) {
    read_designs(fields, request.designs, limits);
    read_strains(fields, request.strains, limits);
    int derivatives = static_cast<int>(request.order);
    fields.integer("derivatives", derivatives, 0, 2);
    request.order = static_cast<neural::Order>(derivatives);
  });
}

UniaxialRequest parse_uniaxial(std::string_view body, const Limits& limits, const CancellationToken& cancellation) {
  return read_request<UniaxialRequest>(body, limits, cancellation, [&](Fields& fields, UniaxialRequest& request) {
    if (const auto* parameters = fields.required("parameters")) {
      read_design(*parameters, fields.at("parameters"), fields.faults(), request.parameters);
    }
    fields.required("direction");
    fields.number("direction", request.direction, -max_angle, max_angle);
    if (fields.is_object() && fields.present("stretches") == fields.present("green_strains")) {
      fields.faults().add("", "must have exactly one of \"stretches\" and \"green_strains\"");
    }
    std::vector<double> stretches;
    read_path(fields, "stretches", limits, stretches, min_stretch, max_stretch, false);
    read_path(fields, "green_strains", limits, request.green_strains, min_uniaxial_strain, max_uniaxial_strain, true);
    for (const double stretch : stretches) request.green_strains.push_back(neural::green_strain_of_stretch(stretch));
    nested(fields, "accuracy", [&](Fields& accuracy) {
      accuracy.number("tolerance", request.options.tolerance, min_tolerance, max_tolerance);
      accuracy.integer("max_iterations", request.options.max_iterations, 1, max_solver_iterations);
    });
  });
}

}  // namespace supple::json
