#include "supple/json/design_answers.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "answer_parts.h"
#include "supple/design/verification.h"

namespace supple::json {
namespace {

void write_numbers_or_nulls(JsonWriter& out, std::string_view name, const Eigen::VectorXd& values) {
  out.key(name).begin_array();
  for (const double value : values) {
    if (std::isfinite(value)) {
      out.number(value);
    } else {
      out.null();
    }
  }
  out.end_array();
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
  out.field("task", design::to_string(samples.task));
  if (samples.task == design::Task::stress_strain) {
    out.field("direction", samples.direction);
  } else {
    out.field("strain", samples.strain);
  }
  out.field("strain_measure", design::to_string(samples.measure));
}

void write_verified(JsonWriter& out, const VerifiedProfile* verified) {
  out.key("verified");
  if (!verified) {
    out.null();
    return;
  }
  out.begin_object().key("x").numbers(verified->x);
  write_numbers_or_nulls(out, "y", verified->simulated);
  out.key("model").numbers(verified->model);
  if (const auto difference = design::relative_difference(verified->simulated, verified->model))
    out.field("relative_rms", *difference);
  out.end_object();
}

void write_design_profile(JsonWriter& out, const design::DesignProfile& profile, const VerifiedProfile* verified) {
  out.begin_object();
  write_kind(out, profile.target.samples);
  out.key("x").numbers(profile.target.samples.x);
  out.key("target").numbers(profile.target.y);
  write_numbers_or_nulls(out, "initial", profile.initial);
  out.key("achieved").numbers(profile.achieved);
  write_verified(out, verified);
  write_flags(out, "in_range", profile.in_range);
  write_flags(out, "reached", profile.reached);
  out.key("envelope");
  if (profile.lowest.size() == 0) {
    out.null();
  } else {
    out.begin_object().key("lower").numbers(profile.lowest).key("upper").numbers(profile.highest).end_object();
  }
  out.end_object();
}

void write_error(JsonWriter& out, const design::DesignError& error) {
  out.key("error").begin_object().field("relative_rms", error.relative_rms).field("max", error.max).end_object();
}

std::string plain(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

void write_structure_links(JsonWriter& out, const std::string& family, const Eigen::VectorXd& parameters) {
  std::string path = "/v1/families/" + family + "/structure?parameters=";
  for (Eigen::Index k = 0; k < parameters.size(); ++k) {
    if (k > 0) path += ',';
    path += plain(parameters[k]);
  }
  out.key("structure").begin_object();
  path += "&format=";
  for (const std::string format : {"svg", "dxf", "stl"}) out.field(format, path + format);
  out.end_object();
}

/// The fields of one design, without the braces.
void write_found(JsonWriter& out, const FoundDesigns& found) {
  const auto& best = found.ranking.front();
  const auto& model = found.models[best.space];
  if (!found.name.empty()) out.field("name", found.name);
  write_model(out, model, true);
  out.key("parameters").numbers(best.parameters);
  out.key("profile");
  write_design_profile(out, best.profiles.front(), found.verified ? &*found.verified : nullptr);
  out.key("also").begin_array();
  for (std::size_t t = 1; t < best.profiles.size(); ++t) write_design_profile(out, best.profiles[t], nullptr);
  out.end_array();
  write_error(out, best.error);
  out.field("reached", best.reached).field("iterations", best.iterations).field("starts", best.starts);
  out.field("stopped", design::to_string(best.stopped)).field("message", best.message);
  out.key("ranking").begin_array();
  for (const auto& design : found.ranking) {
    out.begin_object();
    write_model(out, found.models[design.space], false);
    out.key("parameters").numbers(design.parameters);
    write_error(out, design.error);
    out.key("model_error");
    if (design.model_error) {
      out.number(*design.model_error);
    } else {
      out.null();
    }
    out.field("stopped", design::to_string(design.stopped)).end_object();
  }
  out.end_array();
  write_structure_links(out, model.family, best.parameters);
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
  for (const auto& region : found) residual = std::max(residual, region.ranking.front().residual);
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
  out.key("x").numbers(progress.samples.x);
  out.key("achieved").numbers(progress.achieved);
  write_error(out, progress.error);
  out.field("iteration", progress.iteration).end_object();
  return out.take();
}

std::string write_profile(const DesignModel& model, const ProfileRequest& request, const design::Profile& profile,
                          const Bill& bill) {
  JsonWriter out;
  out.begin_object();
  write_model(out, model, true);
  out.key("parameters").numbers(request.parameters);
  write_kind(out, request.samples);
  out.key("x").numbers(request.samples.x);
  write_numbers_or_nulls(out, "y", profile.y);
  write_flags(out, "in_range", profile.in_range);
  out.key("accuracy").begin_object().field("equilibrium_tolerance", request.equilibrium_tolerance);
  out.field("residual", profile.residual).end_object();
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
