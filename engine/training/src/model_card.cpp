#include "supple/training/model_card.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <vector>

#include "supple/base/error.h"
#include "supple/training/model_errors.h"
#include "supple/training/model_training.h"

namespace supple::training {
namespace {

/// The page warns of a kind of states if its mean error is more than this multiple of that of all states.
constexpr double warning_ratio = 2;
constexpr std::size_t listed_worst_designs = 5;

/// A sample of a test design with its relative errors.
struct EvaluatedSample {
  const dataset::Design* design = nullptr;
  const dataset::Row* row = nullptr;
  double energy_error = 0;
  double gradient_error = 0;
  double stiffness_error = 0;

  const dataset::Path& path() const { return design->paths[static_cast<std::size_t>(row->path)]; }
};

std::vector<EvaluatedSample> evaluate_test_samples(const neural::Model& model, const ModelData& data) {
  const auto [samples, parts, options] = samples_of(model, data);
  const auto errors = row_errors(model.network, samples, parts.test);
  std::vector<EvaluatedSample> evaluated;
  for (std::size_t i = 0; i < errors.rows.size(); ++i) {
    const auto& source = samples.source[static_cast<std::size_t>(errors.rows[i])];
    // Test designs are all of `data.data`, because ModelData::more is for training alone.
    const auto& design = data.data.designs[static_cast<std::size_t>(source.design)];
    evaluated.push_back({&design, &design.rows[static_cast<std::size_t>(source.row)],
                         errors.energy[static_cast<long>(i)], errors.gradient[static_cast<long>(i)],
                         errors.stiffness[static_cast<long>(i)]});
  }
  return evaluated;
}

struct StateKind {
  std::string name;
  std::function<bool(const EvaluatedSample&)> belongs;
};

const std::vector<StateKind>& kinds() {
  using dataset::LoadKind;
  const auto energy = [](double low, double high) {
    return [=](const EvaluatedSample& sample) {
      return sample.row->energy_density >= low && sample.row->energy_density < high;
    };
  };
  static const std::vector<StateKind> all{
      {"uniaxial tension",
       [](const auto& sample) { return sample.path().kind == LoadKind::uniaxial && sample.row->stretch > 1; }},
      {"uniaxial compression",
       [](const auto& sample) { return sample.path().kind == LoadKind::uniaxial && sample.row->stretch < 1; }},
      {"biaxial", [](const auto& sample) { return sample.path().kind == LoadKind::biaxial; }},
      {"before buckling", [](const auto& sample) { return sample.row->branch == 0; }},
      {"after buckling", [](const auto& sample) { return sample.row->branch > 0; }},
      {"beams in contact", [](const auto& sample) { return sample.row->contacts > 0; }},
      {"energy below 0.001 MPa", energy(0, 1e-3)},
      {"energy 0.001 to 0.1 MPa", energy(1e-3, 0.1)},
      {"energy above 0.1 MPa", energy(0.1, 1e300)}};
  return all;
}

Eigen::VectorXd errors_of(const std::vector<EvaluatedSample>& evaluated, double EvaluatedSample::*error) {
  Eigen::VectorXd errors(static_cast<long>(evaluated.size()));
  for (std::size_t i = 0; i < evaluated.size(); ++i) errors[static_cast<long>(i)] = evaluated[i].*error;
  return errors;
}

std::string statistics_row(const std::string& name, const neural::ErrorStatistics& gradient,
                           const neural::ErrorStatistics& energy, std::int64_t samples) {
  return fmt::format("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.1f} | {:.2f} | {:.2f} | {:.2f} | {:.1f} |\n", name,
                     samples, 100 * gradient.mean, 100 * gradient.root_mean_square, 100 * gradient.median,
                     100 * gradient.percentile_99, 100 * energy.mean, 100 * energy.root_mean_square,
                     100 * energy.median, 100 * energy.percentile_99);
}

constexpr const char* statistics_head =
    "| | Samples | Gradient: mean | RMS | Median | 99th percentile | Energy: mean | RMS | Median | 99th percentile |\n"
    "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";

std::string stiffness_row(const std::string& name, const std::vector<EvaluatedSample>& evaluated) {
  const auto errors = errors_of(evaluated, &EvaluatedSample::stiffness_error);
  return fmt::format("| {} | {:.2f} | {:.1f} | {:.1f} |\n", name, 100 * quantile(errors, 0.5),
                     100 * quantile(errors, 0.75), 100 * quantile(errors, 0.9));
}

const char* name_of(neural::Quantity quantity) {
  switch (quantity) {
    case neural::Quantity::stiffness:
      return "stiffness along a uniaxial load";
    case neural::Quantity::poisson:
      return "Poisson's ratio";
    case neural::Quantity::stress_at_strain:
      return "stress at a given strain";
    default:
      return "stress along a uniaxial load";
  }
}

std::string error_section(const neural::Model& model) {
  std::string text = fmt::format(
      "## Errors\n\nRelative, in percent: |S - S*| / |S*| of the stress (the energy's gradient) and |psi - "
      "psi*| / psi* of the energy density, over simulated states of at least 1e-5 MPa.{}\n\n",
      model.network.mesh_correction.size() > 0
          ? " The network is compared with its data as these have taught it, without its correction of their mesh."
          : "");
  text += statistics_head;
  if (model.design_split)
    text += statistics_row(fmt::format("{} designs that training has not seen", model.design_split->designs),
                           model.design_split->gradient, model.design_split->energy, model.design_split->samples);
  if (model.row_split)
    text += statistics_row("other states of designs that it has seen", model.row_split->gradient,
                           model.row_split->energy, model.row_split->samples);
  if (const auto published = published_errors(model.family))
    text += fmt::format(
        "\nThe thesis's network, judged by other states of designs that it has seen: {:.3g} % (gradient) and "
        "{:.3g} % (energy) in the mean.\n",
        100 * published->gradient, 100 * published->energy);
  return text;
}

std::string error_kinds_section(const std::vector<EvaluatedSample>& evaluated) {
  std::string text = "\n## Where they are\n\nOn designs that training has not seen.\n\n";
  text += statistics_head;
  std::string stiffness;
  for (const auto& kind : kinds()) {
    std::vector<EvaluatedSample> matching;
    std::copy_if(evaluated.begin(), evaluated.end(), std::back_inserter(matching), kind.belongs);
    if (matching.empty()) continue;
    text += statistics_row(kind.name, statistics(errors_of(matching, &EvaluatedSample::gradient_error)),
                           statistics(errors_of(matching, &EvaluatedSample::energy_error)),
                           static_cast<std::int64_t>(matching.size()));
    stiffness += stiffness_row(kind.name, matching);
  }
  text +=
      "\nOf the tangent stiffness against more of the state's own load, |v^T (C - C*) v| / |v^T C* v| with v = C*^-1 "
      "S*. "
      "Where a structure buckles it jumps or vanishes, so that shares of the states say more than means.\n\n"
      "| | Median | Of three quarters at most | Of nine tenths at most |\n|---|---:|---:|---:|\n";
  return text + stiffness_row("all", evaluated) + stiffness;
}

std::string trust_section(const neural::Model& model, const std::vector<EvaluatedSample>& evaluated) {
  std::string text = "\n## Where not to trust it\n\n";
  const double all = errors_of(evaluated, &EvaluatedSample::gradient_error).mean();
  for (const auto& kind : kinds()) {
    std::vector<EvaluatedSample> matching;
    std::copy_if(evaluated.begin(), evaluated.end(), std::back_inserter(matching), kind.belongs);
    if (matching.empty()) continue;
    const double mean = errors_of(matching, &EvaluatedSample::gradient_error).mean();
    if (mean > warning_ratio * all)
      text += fmt::format("- States {}: the mean error of the stress is {:.1f} times that of all states.\n", kind.name,
                          mean / all);
  }
  std::map<const dataset::Design*, std::pair<double, int>> by_design;
  for (const auto& sample : evaluated) {
    auto& [sum, count] = by_design[sample.design];
    sum += sample.gradient_error;
    ++count;
  }
  std::vector<std::pair<double, const dataset::Design*>> worst;
  worst.reserve(by_design.size());
  for (const auto& [design, entry] : by_design) worst.emplace_back(entry.first / entry.second, design);
  std::sort(worst.begin(), worst.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second->index < b.second->index;
  });
  text += fmt::format("- The worst of the {} designs:", worst.size());
  for (std::size_t i = 0; i < std::min(listed_worst_designs, worst.size()); ++i)
    text += fmt::format("{} ({:.4g}): {:.1f} %", i == 0 ? "" : ",", fmt::join(worst[i].second->parameters, ", "),
                        100 * worst[i].first);
  text += ".\n";
  const auto& range = model.strain_range;
  text += fmt::format(
      "- Where an answer says `in_range: false`: parameters out of bounds, principal Green strains outside of "
      "[{:.3g}, {:.3g}], or an energy density above {:.3g} of the design's rest stiffness, which no simulated path "
      "reached{}.\n",
      range.smallest_principal, range.largest_principal, range.largest_relative_energy,
      model.calibration ? "; or an error bar longer than is trusted" : "");
  text += "- After buckling a structure has several equilibria; the model knows those that a path from rest meets.\n";
  return text;
}

/// The value of an option of the model's training; empty if the model does not record it.
std::string option_value(const neural::Model& model, const char* option_name) {
  for (const auto& [name, value] : model.provenance.options)
    if (name == option_name) return value;
  return {};
}

/// Sentences about the network's inputs, its stiffness branch and the network with which its training began.
std::string training_choices(const neural::Model& model) {
  const auto& shape = model.network.shape;
  std::string text;
  if (shape.features > 0)
    text +=
        fmt::format(" Designs are read by {} features of their tile beside the parameters (`--features geometric`).",
                    shape.features);
  if (shape.form == neural::EnergyForm::sum_of_squares) {
    const auto rest = option_value(model, "rest_designs");
    text += fmt::format(
        " The stiffness branch has {} hidden layer{} of {}{}{}; the stiffness at rest is {} (`--rest {}`).",
        shape.stiffness_layers, shape.stiffness_layers == 1 ? "" : "s", shape.stiffness_width,
        rest.empty() ? ""
                     : fmt::format(", was fitted to the stiffness at rest of {} designs first (`--rest-data`)", rest),
        option_value(model, "freeze_stiffness") == "1" ? " and then stayed as it was (`--freeze-stiffness`)" : "",
        shape.rest == neural::RestForm::exact ? "its own alone" : "learned by all branches", to_string(shape.rest));
  }
  if (const auto start = option_value(model, "start_model"); !start.empty())
    text += fmt::format(" Training began with the model {} of other data, {} (`--start-foreign`).", start,
                        option_value(model, "start_data"));
  return text;
}

std::string bars_row(const std::string& name, neural::Quantity quantity, const neural::BarCoverage& bars) {
  const bool is_absolute = quantity == neural::Quantity::poisson;
  const auto size = [&](double error) {
    return is_absolute ? fmt::format("{:.3g}", error) : fmt::format("{:.3g} %", 100 * error);
  };
  return fmt::format("| {} | {} | {} | {:.1f} % | {} | {} | {} | {} | {} | {} | {} |\n", name, bars.designs,
                     bars.states, 100 * bars.share, size(bars.median_bar), size(neural::max_trusted_error(quantity)),
                     bars.beyond, bars.beyond_in_box, bars.beyond_in_range, bars.within,
                     bars.within - bars.within_in_range);
}

std::string calibration_section(const neural::Model& model) {
  if (!model.calibration) return {};
  const auto& calibration = *model.calibration;
  std::string text = fmt::format(
      "\n## Error bars\n\nEach answer has an error bar, which the simulated value is within in {:.0f} of 100 cases "
      "(`supple-lab calibrate`; [how](../docs/models.md#error-bars)). Judged on {}, each by bars that were made "
      "without "
      "it. \"Beyond\" are states that err by more than 3.57 %, the thesis's worst error of a uniaxial stress, or by "
      "0.0357 of Poisson's ratio; `in_range` is false also where the bar is longer than is trusted.\n\n"
      "| | Designs | States | Within their bar | Median bar | Trusted up to | Beyond | of them `in_range` without bars "
      "| with bars | Others | of them not `in_range` with bars "
      "|\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
      100 * calibration.level,
      calibration.by_fresh_designs ? "fresh designs, simulated without the error of the data's mesh"
                                   : "held-out designs");
  for (const auto quantity : neural::all_quantities)
    text += bars_row(name_of(quantity), quantity, calibration.of(quantity).given.judged);
  for (const auto quantity : neural::all_quantities)
    if (!calibration.of(quantity).searched.knots.empty())
      text += bars_row(fmt::format("{}, of designs that searches have found", name_of(quantity)), quantity,
                       calibration.of(quantity).searched.judged);
  return text + fmt::format("\n![Stated against observed shares]({}-calibration.svg)\n", model.id);
}

std::string origin_section(const neural::Model& model) {
  const auto& p = model.provenance;
  const auto& shape = model.network.shape;
  const auto orientations = model.network.symmetries.size() + 1;
  const auto mean = orientations == 1 ? std::string()
                                      : fmt::format(
                                            " The energy is the mean over {} orientations of a strain, from which the "
                                            "tiling looks the same (`supple-lab symmetrize`).",
                                            orientations);
  std::string text = "\n## Where it comes from\n\n";
  text += fmt::format(
      "{} weights in {} + {} + {} layers of {} neurons, {}, {}.{}{} Trained on {} states of {} designs ({}; simulated "
      "by "
      "{}) of a solid with Young's modulus {} MPa and Poisson's ratio {}, in {:.0f} s, by {}. Options:\n\n",
      model.network.weights(), shape.strain_layers, shape.parameter_layers, shape.trunk_layers, shape.width,
      to_string(shape.activation), to_string(shape.form), mean, training_choices(model), p.rows, p.designs, p.data_set,
      p.data_engine, p.youngs_modulus, p.poisson_ratio, p.training_seconds, p.engine);
  for (const auto& [name, value] : p.options) text += fmt::format("`{} {}` ", name, value);
  text.back() = '\n';
  return text;
}

}  // namespace

std::optional<PublishedErrors> published_errors(const std::string& family) {
  static const std::map<std::string, PublishedErrors> all{{"IH29", {0.0138, 0.00709}}, {"IH21", {0.0161, 0.00883}},
                                                          {"IH50", {0.0114, 0.00921}}, {"IH67", {0.0163, 0.00739}},
                                                          {"IH28", {0.0105, 0.00472}}, {"IH22", {0.0157, 0.0113}},
                                                          {"IH01", {0.0120, 0.00579}}};
  const auto found = all.find(family);
  return found == all.end() ? std::nullopt : std::optional(found->second);
}

std::string model_card(const neural::Model& model, const ModelData& data, const std::string& image) {
  const auto evaluated = evaluate_test_samples(model, data);
  std::string text =
      fmt::format("# {}: energy density of the family {}\n\nThis page is generated by `supple-lab card`.\n\n", model.id,
                  model.family);
  text +=
      "Predicts the homogenized energy density, stress and tangent stiffness of a periodic structure from its tiling "
      "parameters and Green strain.\n\n| Parameter | from | to |\n|---|---:|---:|\n";
  for (long k = 0; k < model.network.lower.size(); ++k)
    text += fmt::format("| {} | {:.4g} | {:.4g} |\n", k + 1, model.network.lower[k], model.network.upper[k]);
  text += "\n" + error_section(model) + error_kinds_section(evaluated);
  text += fmt::format("\n![Relative errors against strain]({})\n", image);
  return text + calibration_section(model) + trust_section(model, evaluated) + origin_section(model);
}

void write_row_errors(const std::filesystem::path& path, const neural::Model& model, const ModelData& data) {
  std::ofstream file(path);
  file << "design,load,direction,stretch,lateral_stretch,strain_norm,energy_density,branch,contacts,gradient_error,"
          "energy_error,stiffness_error\n";
  for (const auto& sample : evaluate_test_samples(model, data)) {
    const auto& e = sample.row->green_strain;
    const double norm = std::sqrt(e[0] * e[0] + e[1] * e[1] + 2 * e[2] * e[2]);
    file << fmt::format("{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{},{},{:.6g},{:.6g},{:.6g}\n", sample.design->index,
                        sample.path().kind == dataset::LoadKind::uniaxial ? "uniaxial" : "biaxial",
                        sample.path().direction, sample.row->stretch, sample.row->lateral_stretch, norm,
                        sample.row->energy_density, sample.row->branch, sample.row->contacts, sample.gradient_error,
                        sample.energy_error, sample.stiffness_error);
  }
  if (!file) throw Error("file.write_failed", "Cannot write " + path.string() + ".");
}

}  // namespace supple::training
