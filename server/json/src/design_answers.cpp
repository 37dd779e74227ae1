#include "supple/json/design_answers.h"

#include <algorithm>
#include <charconv>

#include "answer_parts.h"
#include "supple/design/verdict.h"
#include "supple/design/verification.h"
#include "supple/json/verdict_sentence.h"
#include "supple/tiling/family.h"

namespace supple::json {
namespace {

void write_numbers_or_nulls(JsonWriter& out, std::string_view name, const Eigen::VectorXd& values) {
  out.key(name).begin_array();
  for (const double value : values) write_number_or_null(out, value);
  out.end_array();
}

void write_number_or_null(JsonWriter& out, std::string_view name, const std::optional<double>& value) {
  out.key(name);
  if (value) {
    out.number(*value);
  } else {
    out.null();
  }
}

/// Writes an error bar for each sample, null where it is unknown, or null for all where the model has no error bars.
void write_error_bar(JsonWriter& out, const Eigen::VectorXd& bars) {
  if (bars.size() > 0) {
    write_numbers_or_nulls(out, "error_bar", bars);
  } else {
    out.key("error_bar").null();
  }
}

void write_flags(JsonWriter& out, std::string_view name, const std::vector<std::uint8_t>& flags) {
  out.key(name).begin_array();
  for (const auto flag : flags) out.boolean(flag != 0);
  out.end_array();
}

void write_model(JsonWriter& out, const DesignModel& model, bool with_hash) {
  out.field("family", model.family).field("model", model.id);
  if (with_hash) out.field("sha256", model.sha256);
}

/// Task, direction or strain, and measure.
void write_kind(JsonWriter& out, const design::ProfileSamples& samples) {
  out.field("task", task_names.name_of(samples.task));
  if (samples.task == design::Task::stress_strain) {
    out.field("direction", samples.direction);
  } else {
    out.field("strain", samples.strain);
  }
  out.field("strain_measure", strain_measure_names.name_of(samples.measure));
}

/// One target's profile by simulation beside the model's.
void write_verified(JsonWriter& out, const FoundDesigns& found, std::size_t target) {
  out.key("verified");
  if (!found.verification) {
    out.null();
    return;
  }
  const auto& sampled = found.verification->targets[target];
  const auto& simulated = found.verification->simulated[target];
  const auto& model = found.verification->model[target];
  out.begin_object().key("x").numbers(sampled.samples.x);
  out.key("target").numbers(sampled.y);
  write_numbers_or_nulls(out, "y", simulated);
  write_numbers_or_nulls(out, "model", model);
  if (const auto difference = design::relative_difference(simulated, model)) out.field("relative_rms", *difference);
  write_number_or_null(out, "target_error", sampled.relative_rms(simulated));
  const bool estimated = target < found.discretization_error.size();
  write_number_or_null(out, "discretization_error", estimated ? found.discretization_error[target] : std::nullopt);
  out.end_object();
}

void write_round(JsonWriter& out, const design::PolishRound& round) {
  out.begin_object().field("proposal", design::to_string(round.proposal));
  out.key("parameters").numbers(round.parameters);
  out.field("orientation", round.orientation);
  write_number_or_null(out, "target_error", round.target_error);
  out.field("accepted", round.accepted).field("reason", round.reason).field("seconds", round.seconds).end_object();
}

void write_polish(JsonWriter& out, const std::optional<design::Polished>& verification) {
  out.key("polish");
  if (!verification) {
    out.null();
    return;
  }
  out.begin_object();
  write_number_or_null(out, "target_error", verification->target_error);
  out.field("stopped", design::to_string(verification->stopped)).key("rounds").begin_array();
  for (const auto& round : verification->rounds) write_round(out, round);
  out.end_array().end_object();
}

void write_ranges(JsonWriter& out, const std::vector<design::FitRange>& ranges) {
  out.key("ranges").begin_array();
  for (const design::FitRange& range : ranges) {
    out.begin_object().field("from", range.from).field("to", range.to).field("reached", range.is_reached());
    write_number_or_null(out, "deviation", range.deviation);
    out.end_object();
  }
  out.end_array();
}

void write_verdict(JsonWriter& out, const design::Verdict& verdict, const BoundedTargets& bounded) {
  out.key("verdict").begin_object().field("grade", design::to_string(verdict.grade));
  out.field("source", design::to_string(verdict.source));
  write_number_or_null(out, "deviation", verdict.deviation);
  out.field("sentence", verdict_sentence(verdict)).field("bound", bound_sentence(verdict, bounded)).end_object();
}

void write_rest_profile(JsonWriter& out, const design::RestProfile& profile) {
  out.field("deviation", profile.deviation).key("y").numbers(profile.y);
}

/// The nearest that any material comes to a target at rest.
void write_bound(JsonWriter& out, const BoundedTargets& bounded, std::size_t target) {
  out.key("bound");
  if (target >= bounded.bounds.targets.size() || !bounded.bounds.targets[target]) {
    out.null();
    return;
  }
  const design::MaterialBound& bound = *bounded.bounds.targets[target];
  out.begin_object();
  write_rest_profile(out, bound.alone);
  out.key("together");
  if (bound.together) {
    out.begin_object();
    write_rest_profile(out, *bound.together);
    out.end_object();
  } else {
    out.null();
  }
  out.end_object();
}

/// How much a profile changes with the beam width; null if nobody asked, or nothing is known.
void write_beam_width_sensitivity(JsonWriter& out, const FoundDesigns& found, std::size_t target) {
  out.key("beam_width_sensitivity");
  if (target >= found.beam_width_sensitivity.size()) {
    out.null();
    return;
  }
  const auto& [wider, narrower] = found.beam_width_sensitivity[target];
  out.begin_object();
  write_number_or_null(out, "wider", wider);
  write_number_or_null(out, "narrower", narrower);
  out.end_object();
}

void write_design_profile(JsonWriter& out, const FoundDesigns& found, const design::Verdict& verdict,
                          std::size_t target) {
  const design::DesignProfile& profile = found.ranking.front().design.profiles[target];
  out.begin_object();
  write_kind(out, profile.target.samples);
  out.key("x").numbers(profile.target.samples.x);
  out.key("target").numbers(profile.target.y);
  write_numbers_or_nulls(out, "initial", profile.initial);
  out.key("achieved").numbers(profile.achieved);
  write_error_bar(out, profile.error_bar);
  write_verified(out, found, target);
  write_flags(out, "in_range", profile.in_range);
  write_flags(out, "reached", profile.reached);
  write_ranges(out, verdict.targets[target].ranges);
  out.key("envelope");
  if (profile.lowest.size() == 0) {
    out.null();
  } else {
    out.begin_object().key("lower").numbers(profile.lowest).key("upper").numbers(profile.highest).end_object();
  }
  write_bound(out, found.bounded, target);
  write_beam_width_sensitivity(out, found, target);
  out.end_object();
}

void write_error(JsonWriter& out, const design::DesignError& error) {
  out.key("error").begin_object().field("relative_rms", error.relative_rms).field("max", error.max).end_object();
}

std::string plain(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

/// Writes the measures of the structure. Without a structure (the message says why) there are none, and the beams have
/// the width that the request asks for.
void write_structure(JsonWriter& out, const FoundDesigns& found, double density) {
  const auto& best = found.ranking.front().design;
  const auto& measures = best.measures;
  double beam_width = found.spec.beam_width;
  if (found.spec.cell_size > 0 && measures) beam_width = found.spec.cell_size / measures->cell_size;
  std::string path = "/v1/families/" + found.models[best.space].family + "/structure?parameters=";
  for (Eigen::Index k = 0; k < best.parameters.size(); ++k) {
    if (k > 0) path += ',';
    path += plain(best.parameters[k]);
  }
  if (beam_width != tiling::printed_beam_width) path += "&beam_width=" + plain(beam_width);
  path += "&format=";
  out.key("structure").begin_object();
  for (const std::string format : {"svg", "dxf", "stl"}) out.field(format, path + format);
  out.field("beam_width", beam_width);
  const auto times = [&](double design::StructureMeasures::*measure, double factor) {
    return measures ? std::optional((*measures).*measure * factor) : std::nullopt;
  };
  write_number_or_null(out, "cell_size", times(&design::StructureMeasures::cell_size, beam_width));
  write_number_or_null(out, "relative_density", times(&design::StructureMeasures::relative_density, 1));
  write_number_or_null(out, "density", times(&design::StructureMeasures::relative_density, density));
  out.end_object();
}

/// The material of a design; without materials in the request, that of the model's data.
MaterialSpec material_of(const FoundDesigns& found, const design::Design& design) {
  return found.spec.materials.empty() ? MaterialSpec{} : found.spec.materials[design.material];
}

void write_material(JsonWriter& out, const MaterialSpec& material, double youngs_modulus, const DesignModel& model) {
  out.key("material").begin_object();
  if (!material.name.empty()) out.field("name", material.name);
  out.field("youngs_modulus", youngs_modulus).field("law", "neo_hookean");
  out.field("poisson_ratio", material.poisson_ratio.value_or(model.poisson_ratio));
  out.field("density", material.density).end_object();
}

void write_ways_out(JsonWriter& out, const FoundDesigns& found) {
  const DesignModel& own = found.models[found.ranking.front().design.space];
  out.key("ways_out").begin_array();
  for (const design::WayOut& way : found.ways_out) {
    out.begin_object().field("change", design::to_string(way.change)).field("sentence", way.sentence);
    write_model(out, way.other ? found.other_models[*way.other] : own, false);
    out.key("parameters").numbers(way.parameters);
    out.field("orientation", way.orientation).field("youngs_modulus", way.youngs_modulus);
    out.key("range");
    if (way.range) {
      out.begin_array().number(way.range->least).number(way.range->most).end_array();
    } else {
      out.null();
    }
    out.field("deviation", way.deviation).end_object();
  }
  out.end_array();
}

/// The fields of one design, without the braces.
void write_found(JsonWriter& out, const FoundDesigns& found) {
  const auto& best = found.ranking.front().design;
  const auto& model = found.models[best.space];
  if (!found.spec.name.empty()) out.field("name", found.spec.name);
  write_model(out, model, true);
  out.key("parameters").numbers(best.parameters);
  out.field("orientation", best.orientation);
  const auto material = material_of(found, best);
  write_material(out, material, best.youngs_modulus, model);
  const auto verdict = design::judge(design::evidence_of(best, found.verification ? &*found.verification : nullptr));
  write_verdict(out, verdict, found.bounded);
  out.key("profile");
  write_design_profile(out, found, verdict, 0);
  out.key("also").begin_array();
  for (std::size_t t = 1; t < best.profiles.size(); ++t) write_design_profile(out, found, verdict, t);
  out.end_array();
  write_error(out, best.error);
  out.field("reached", best.reached).field("iterations", best.iterations).field("starts", best.starts);
  out.field("stopped", design::to_string(best.stopped)).field("message", best.message);
  write_polish(out, found.verification);
  out.key("ranking").begin_array();
  for (const auto& [design, simulated_error] : found.ranking) {
    out.begin_object();
    write_model(out, found.models[design.space], false);
    out.key("parameters").numbers(design.parameters);
    out.field("orientation", design.orientation);
    write_material(out, material_of(found, design), design.youngs_modulus, found.models[design.space]);
    write_error(out, design.error);
    write_number_or_null(out, "model_error", design.model_error);
    write_number_or_null(out, "simulated_error", simulated_error);
    out.field("stopped", design::to_string(design.stopped)).end_object();
  }
  out.end_array();
  write_ways_out(out, found);
  write_structure(out, found, material.density);
}

}  // namespace

std::string write_design(const DesignRequest& request, const std::vector<FoundDesigns>& found, const Bill& bill) {
  JsonWriter out;
  out.begin_object();
  if (request.several) {
    out.key("regions").begin_array();
    for (const auto& region : found) {
      out.begin_object();
      write_found(out, region);
      out.end_object();
    }
    out.end_array();
  } else {
    write_found(out, found.front());
  }
  double residual = 0;
  for (const auto& region : found) residual = std::max(residual, region.ranking.front().design.residual);
  out.key("accuracy").begin_object().field("tolerance", request.options.tolerance);
  out.field("equilibrium_tolerance", request.options.equilibrium_tolerance).field("residual", residual).end_object();
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_partial_design(const std::string& name, const DesignModel& model,
                                 const design::DesignProgress& progress) {
  JsonWriter out;
  out.begin_object();
  if (!name.empty()) out.field("name", name);
  write_model(out, model, false);
  out.key("parameters").numbers(progress.parameters);
  out.field("orientation", progress.orientation);
  out.key("x").numbers(progress.samples.x);
  out.key("achieved").numbers(progress.achieved);
  write_error(out, progress.error);
  out.field("iteration", progress.iteration).end_object();
  return out.take();
}

std::string write_partial_round(const std::string& name, const DesignModel& model, const design::PolishRound& round) {
  JsonWriter out;
  out.begin_object();
  if (!name.empty()) out.field("name", name);
  write_model(out, model, false);
  out.key("round");
  write_round(out, round);
  out.end_object();
  return out.take();
}

std::string write_profile(const DesignModel& model, const ProfileRequest& request, const design::Profile& profile,
                          const Bill& bill) {
  JsonWriter out;
  out.begin_object();
  write_model(out, model, true);
  out.key("parameters").numbers(request.parameters);
  out.field("orientation", request.samples.orientation);
  const auto material = request.material.value_or(MaterialSpec{});
  write_material(out, material, material.has_modulus ? material.youngs_modulus.least : model.youngs_modulus, model);
  write_kind(out, request.samples);
  out.key("x").numbers(request.samples.x);
  write_numbers_or_nulls(out, "y", profile.y);
  write_error_bar(out, profile.error_bar);
  write_flags(out, "in_range", profile.in_range);
  out.key("accuracy").begin_object().field("equilibrium_tolerance", request.equilibrium_tolerance);
  out.field("residual", profile.residual).end_object();
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
