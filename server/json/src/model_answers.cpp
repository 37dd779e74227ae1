#include "supple/json/model_answers.h"

#include <cmath>

#include "answer_parts.h"

namespace supple::json {
namespace {

void write_statistics(JsonWriter& out, std::string_view name, const neural::ErrorStatistics& errors) {
  out.key(name)
      .begin_object()
      .field("mean", errors.mean)
      .field("root_mean_square", errors.root_mean_square)
      .field("median", errors.median)
      .field("percentile_99", errors.percentile_99)
      .end_object();
}

void write_split(JsonWriter& out, std::string_view name, const std::optional<neural::SplitErrors>& split) {
  out.key(name);
  if (!split) {
    out.null();
    return;
  }
  out.begin_object();
  write_statistics(out, "gradient", split->gradient);
  write_statistics(out, "energy", split->energy);
  out.field("designs", split->designs).field("samples", split->samples).end_object();
}

JsonWriter& write_judged_bars(JsonWriter& out, const neural::BarCoverage& judged) {
  return out.field("median", judged.median_bar)
      .field("share", judged.share)
      .field("designs", judged.designs)
      .field("samples", judged.states);
}

void write_error_bars(JsonWriter& out, const std::optional<neural::Calibration>& calibration) {
  out.key("error_bars");
  if (!calibration) {
    out.null();
    return;
  }
  out.begin_object().field("level", calibration->level);
  out.field("judged_by", calibration->by_fresh_designs ? "fresh" : "held_out");
  for (const auto quantity : neural::all_quantities) {
    const auto& scale = calibration->of(quantity);
    out.key(neural::to_string(quantity)).begin_object().field("trusted", neural::max_trusted_error(quantity));
    write_judged_bars(out, scale.given.judged);
    if (!scale.searched.knots.empty()) {
      out.key("searched").begin_object();
      write_judged_bars(out, scale.searched.judged).end_object();
    }
    out.end_object();
  }
  out.end_object();
}

void write_network(JsonWriter& out, const neural::Network& network) {
  const auto& shape = network.shape;
  out.key("network")
      .begin_object()
      .field("form", neural::to_string(shape.form))
      .field("activation", neural::to_string(shape.activation))
      .field("width", shape.width)
      .field("strain_layers", shape.strain_layers)
      .field("parameter_layers", shape.parameter_layers)
      .field("trunk_layers", shape.trunk_layers)
      .field("residuals", shape.outputs())
      .field("weights", network.weights())
      .field("corrects_mesh", network.mesh_correction.size() > 0)
      .end_object();
}

void write_provenance(JsonWriter& out, const neural::Provenance& provenance) {
  out.key("provenance")
      .begin_object()
      .field("data_set", provenance.data_set)
      .field("data_engine", provenance.data_engine)
      .field("engine", provenance.engine)
      .field("designs", provenance.designs)
      .field("rows", provenance.rows)
      .field("seed", provenance.seed);
  out.key("options").begin_object();
  for (const auto& [name, value] : provenance.options) out.text_key(name).string(value);
  out.end_object().field("training_seconds", provenance.training_seconds).end_object();
}

void begin_answer(JsonWriter& out, const ModelVersion& model) {
  out.begin_object().field("model", model.id).field("sha256", model.sha256);
}

/// Writes a strain with the tensor component xy; the engine has twice of it.
void write_strain(JsonWriter& out, const Eigen::Vector3d& strain) {
  out.key("green_strain").numbers(Eigen::Vector3d(strain[0], strain[1], strain[2] / 2));
}

/// Writes the error bar of a value of this size.
void write_bar(JsonWriter& out, const neural::Trust& trust, double size) {
  if (trust.error && std::isfinite(size)) {
    out.number(*trust.error * size);
  } else {
    out.null();
  }
}

void write_tangents(JsonWriter& out, const neural::Evaluation& values) {
  out.key("tangent").begin_array();
  for (Eigen::Index i = 0; i < values.tangent.cols(); ++i) {
    const auto c = values.tangent.col(i);
    Eigen::Matrix3d tangent;
    tangent << c[0], c[1], c[2],  //
        c[1], c[3], c[4],         //
        c[2], c[4], c[5];
    write_rows(out, tangent);
  }
  out.end_array();
}

void write_state(JsonWriter& out, const neural::UniaxialState& state, const neural::Trust& trust) {
  out.begin_object();
  write_strain(out, state.strain);
  out.key("stress").numbers(state.stress);
  out.field("directional_stress", state.directional_stress).key("error_bar");
  write_bar(out, trust, std::abs(state.directional_stress));
  out.field("energy_density", state.energy_density)
      .field("in_range", trust.in_range)
      .field("converged", state.converged);
  write_number_or_null(out, "residual", state.residual);
  out.field("iterations", state.iterations).end_object();
}

}  // namespace

std::string write_model(const neural::Model& model, const std::string& sha256) {
  JsonWriter out;
  out.begin_object().field("id", model.id).field("family", model.family);
  out.key("parameters").begin_object().key("lower").numbers(model.network.lower);
  out.key("upper").numbers(model.network.upper).end_object();
  out.key("strain_range")
      .begin_object()
      .field("smallest_principal", model.strain_range.smallest_principal)
      .field("largest_principal", model.strain_range.largest_principal)
      .field("largest_relative_energy", model.strain_range.largest_relative_energy)
      .end_object();
  out.key("errors").begin_object();
  write_split(out, "design_split", model.design_split);
  write_split(out, "row_split", model.row_split);
  out.end_object();
  write_error_bars(out, model.calibration);
  write_network(out, model.network);
  write_provenance(out, model.provenance);
  out.key("material")
      .begin_object()
      .field("youngs_modulus", model.provenance.youngs_modulus)
      .field("poisson_ratio", model.provenance.poisson_ratio)
      .end_object();
  out.field("sha256", sha256).end_object();
  return out.take();
}

std::string write_evaluation(const ModelVersion& model, neural::Order order, const neural::Evaluation& values,
                             const std::vector<neural::Trust>& trust, bool has_bars, const Bill& bill) {
  JsonWriter out;
  begin_answer(out, model);
  out.key("energy_density").numbers(values.energy_density);
  if (order >= neural::Order::stress) {
    out.key("stress");
    write_rows(out, values.stress.transpose());
    out.key("stress_error_bar");
    if (has_bars) {
      out.begin_array();
      for (Eigen::Index i = 0; i < values.stress.cols(); ++i)
        write_bar(out, trust[static_cast<std::size_t>(i)], values.stress.col(i).norm());
      out.end_array();
    } else {
      out.null();
    }
  }
  if (order >= neural::Order::tangent) write_tangents(out, values);
  out.key("in_range").begin_array();
  for (const auto& of_strain : trust) out.boolean(of_strain.in_range);
  out.end_array();
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_uniaxial(const ModelVersion& model, const UniaxialRequest& request,
                           const std::vector<neural::UniaxialState>& states, const std::vector<neural::Trust>& trust,
                           const Bill& bill) {
  JsonWriter out;
  begin_answer(out, model);
  out.key("parameters").numbers(request.parameters).field("direction", request.direction);
  double residual = 0;
  out.key("states").begin_array();
  for (std::size_t i = 0; i < states.size(); ++i) {
    write_state(out, states[i], trust[i]);
    // Unlike std::max, this keeps a value that is not a number.
    if (std::isfinite(residual) && !(states[i].residual <= residual)) residual = states[i].residual;
  }
  out.end_array();
  out.key("accuracy").begin_object().field("tolerance", request.options.tolerance);
  write_number_or_null(out, "residual", residual);
  out.end_object();
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
