#include "design_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "cost_output.h"
#include "csv_cells.h"
#include "style.h"
#include "table_numbers.h"

namespace supple::cli {
namespace {

std::string text_in(const nlohmann::json& object, const char* name) { return object.at(name).get<std::string>(); }

std::string numbers_text(const nlohmann::json& values) {
  std::string text;
  for (const auto& value : values) text += fmt::format("{}{:.6g}", text.empty() ? "" : ", ", value.get<double>());
  return text;
}

std::string percent(const nlohmann::json& error) {
  return fmt::format("{:.3g} %", 100 * error.at("relative_rms").get<double>());
}

const char* x_heading(const nlohmann::json& profile) {
  return profile.at("task") == "stress_strain" ? "strain" : "angle/rad";
}

const char* y_unit(const nlohmann::json& profile) { return profile.at("task") == "poisson" ? "" : "/MPa"; }

/// What the profile shows, such as "stiffness over directions at the Green strain 0.05".
std::string kind_text(const nlohmann::json& profile) {
  const bool green = profile.at("strain_measure") == "green";
  if (profile.at("task") == "stress_strain") {
    return fmt::format("stress over {} strain along {:.6g} rad", green ? "Green" : "engineering",
                       profile.at("direction").get<double>());
  }
  return fmt::format("{} over directions at the {} strain {:.6g}",
                     profile.at("task") == "poisson" ? "Poisson's ratio" : "stiffness", green ? "Green" : "engineering",
                     profile.at("strain").get<double>());
}

/// The simulated value at a sample; nothing if there is none.
std::optional<nlohmann::json> verified_at(const nlohmann::json& profile, const nlohmann::json& x) {
  const auto& verified = profile.at("verified");
  if (verified.is_null()) return std::nullopt;
  const auto& places = verified.at("x");
  const auto found = std::find(places.begin(), places.end(), x);
  if (found == places.end()) return std::nullopt;
  return verified.at("y").at(static_cast<std::size_t>(found - places.begin()));
}

/// The error bar of sample `i`; null if the answer has none.
nlohmann::json error_bar_at(const nlohmann::json& profile, std::size_t i) {
  const auto& bars = profile.at("error_bar");
  return bars.is_null() ? nlohmann::json(nullptr) : bars.at(i);
}

/// Whether the simulation reaches the target at a sample that was simulated: what the range says in which it lies.
const char* simulation_reaches(const nlohmann::json& profile, double x) {
  bool reaches = true;
  for (const auto& range : profile.at("ranges")) {
    if (range.at("from").get<double>() <= x && x <= range.at("to").get<double>())
      reaches = reaches && range.at("reached").get<bool>();
  }
  return reaches ? "yes" : "no";
}

void print_samples(const nlohmann::json& profile) {
  const bool verified = !profile.at("verified").is_null();
  const std::string unit = y_unit(profile);
  fmt::print("{}\n{:>10}  {:>12} {:>12} {:>9} {:>12}", kind_text(profile), x_heading(profile), "target" + unit,
             "model" + unit, "error bar", "initial" + unit);
  if (verified) fmt::print(" {:>13}  {:<18}", "simulated" + unit, "simulation reaches");
  fmt::print("  {:<13}  {}\n", "model reaches", "in range");
  const auto& xs = profile.at("x");
  const double scale = scale_of({&profile.at("target"), &profile.at("achieved")});
  for (std::size_t i = 0; i < xs.size(); ++i) {
    fmt::print("{:>10}  {:>12} {:>12} {:>9} {:>12}", with_decimals(xs[i].get<double>()),
               rounded(profile.at("target")[i], scale), rounded(profile.at("achieved")[i], scale),
               error_bar_text(error_bar_at(profile, i), scale), rounded(profile.at("initial")[i], scale));
    if (verified) {
      const auto value = verified_at(profile, xs[i]);
      fmt::print(" {:>13}  {:<18}", value ? rounded(*value, scale) : "",
                 value ? simulation_reaches(profile, xs[i].get<double>()) : "");
    }
    fmt::print("  {:<13}  {}\n", profile.at("reached")[i].get<bool>() ? "yes" : "no",
               profile.at("in_range")[i].get<bool>() ? "yes" : "no");
  }
}

std::string error_text(const nlohmann::json& error) {
  return error.is_null() ? "not simulated" : fmt::format("{:.3g} %", 100 * error.get<double>());
}

void print_ranking(const nlohmann::json& ranking) {
  bool simulated = false;
  for (const auto& candidate : ranking) simulated = simulated || !candidate.at("simulated_error").is_null();
  fmt::print("ranking     {}\n", simulated ? "by the simulation, and by the model those that were not simulated"
                                           : "by the model: nothing was simulated");
  fmt::print("{:>4}  {:<8}  {:<10}", "rank", "family", "model");
  if (simulated) fmt::print("  {:>13}", "simulation");
  fmt::print("  {:>10}  {:>11}  {:>13}  {:>9}  {:<16}  {}\n", "by model", "model error", "model at most", "E, MPa",
             "stopped", "parameters");
  int rank = 0;
  for (const auto& candidate : ranking) {
    const auto& error = candidate.at("error");
    const auto& model_error = candidate.at("model_error");
    fmt::print("{:>4}  {:<8}  {:<10}", ++rank, text_in(candidate, "family"), text_in(candidate, "model"));
    if (simulated) fmt::print("  {:>13}", error_text(candidate.at("simulated_error")));
    fmt::print("  {:>10}  {:>11}  {:>13}  {:>9}  {:<16}  {}\n", percent(error),
               model_error.is_null() ? "unknown" : fmt::format("{:.3g} %", 100 * model_error.get<double>()),
               fmt::format("{:.3g}", error.at("max").get<double>()),
               fmt::format("{:.4g}", candidate.at("material").at("youngs_modulus").get<double>()),
               text_in(candidate, "stopped"), numbers_text(candidate.at("parameters")));
  }
}

void print_polish(const nlohmann::json& polish) {
  const auto& rounds = polish.at("rounds");
  fmt::print("simulated   {} from the target", error_text(polish.at("target_error")));
  if (rounds.size() > 1)
    fmt::print(", {} before it was polished in {} {}", error_text(rounds[0].at("target_error")), rounds.size() - 1,
               rounds.size() == 2 ? "round" : "rounds");
  fmt::print(" ({})\n", text_in(polish, "stopped"));
  if (rounds.size() < 2) return;
  fmt::print("{:>5}  {:>13}  {:>7}  {:<10}  {}\n", "round", "simulation", "seconds", "proposal", "kept");
  int number = 0;
  for (const auto& round : rounds)
    fmt::print("{:>5}  {:>13}  {:>7.3g}  {:<10}  {}\n", number++, error_text(round.at("target_error")),
               round.at("seconds").get<double>(), text_in(round, "proposal"),
               round.at("accepted").get<bool>() ? "yes" : "no: " + text_in(round, "reason"));
}

void print_structure(const nlohmann::json& material, const nlohmann::json& structure) {
  fmt::print("material    {}{}{:.5g} MPa, {:.4g} g/cm^3\n", material.value("name", ""),
             material.contains("name") ? ", " : "", material.at("youngs_modulus").get<double>(),
             material.at("density").get<double>());
  fmt::print("structure   beams of {:.4g} mm", structure.at("beam_width").get<double>());
  if (!structure.at("cell_size").is_null())
    fmt::print(", cells of {:.4g} mm, {:.3g} % solid, {:.3g} g/cm^3", structure.at("cell_size").get<double>(),
               100 * structure.at("relative_density").get<double>(), structure.at("density").get<double>());
  fmt::print("\n");
}

/// The verdict in the server's words, and what no material can have; older servers do not tell the latter.
void print_verdict(const nlohmann::json& verdict) {
  const auto sentence = text_in(verdict, "sentence");
  fmt::print("{}\n", styled(sentence, text_in(verdict, "grade") == "reached" ? Style::success : Style::warning));
  if (const auto bound = verdict.value("bound", ""); !bound.empty()) fmt::print("{}\n", bound);
}

/// What would help where the target is missed; older servers do not tell.
void print_ways_out(const nlohmann::json& design) {
  const auto ways = design.find("ways_out");
  if (ways == design.end() || ways->empty()) return;
  fmt::print("What helps:\n");
  for (const auto& way : *ways) fmt::print("  {}\n", text_in(way, "sentence"));
}

/// How bad a design is: whether nothing tells that its target is reached, then its deviation.
std::pair<bool, double> badness(const nlohmann::json& design) {
  const auto& verdict = design.at("verdict");
  const auto& deviation = verdict.at("deviation");
  return {misses_target(design),
          deviation.is_null() ? std::numeric_limits<double>::infinity() : deviation.get<double>()};
}

/// How much a profile changes with the beam width; older servers do not tell.
void print_beam_width_sensitivity(const nlohmann::json& profile) {
  const auto found = profile.find("beam_width_sensitivity");
  if (found == profile.end() || found->is_null()) return;
  const auto change = [&](const char* side) {
    const auto& value = found->at(side);
    return value.is_null() ? std::string("there is no structure") : fmt::format("{:.2g} %", 100 * value.get<double>());
  };
  fmt::print("beam width  {} at rest with beams 5 % wider: {}, 5 % narrower: {}\n",
             profile.at("task") == "stress_strain" ? "changes the modulus" : "changes the profile", change("wider"),
             change("narrower"));
}

void print_design(const nlohmann::json& design) {
  print_verdict(design.at("verdict"));
  const auto& error = design.at("error");
  const auto& profile = design.at("profile");
  if (design.contains("name")) fmt::print("region      {}\n", text_in(design, "name"));
  fmt::print("design      {} ({}) with the model {}\n", text_in(design, "family"),
             numbers_text(design.at("parameters")), text_in(design, "model"));
  if (const double orientation = design.at("orientation").get<double>(); orientation != 0)
    fmt::print("orientation {:.6g} rad ({:.4g} degrees)\n", orientation, orientation * 180 / std::numbers::pi);
  print_structure(design.at("material"), design.at("structure"));
  fmt::print("deviation   {} by the model (root mean square), {:.3g}{} at most\n", percent(error),
             error.at("max").get<double>(), profile.at("task") == "poisson" ? "" : " MPa");
  if (const auto& verified = profile.at("verified"); !verified.is_null() && verified.contains("relative_rms")) {
    fmt::print("simulation  deviates from the model by {} (root mean square)\n", percent(verified));
    if (const auto& mesh = verified.at("discretization_error"); !mesh.is_null())
      fmt::print("mesh        makes an error of less than about {:.2g} %\n", 100 * mesh.get<double>());
  }
  print_beam_width_sensitivity(profile);
  if (const auto& polish = design.at("polish"); !polish.is_null()) print_polish(polish);
  fmt::print("searched    {} iterations from {} starting points, {}\n", design.at("iterations").get<int>(),
             design.at("starts").get<int>(), text_in(design, "stopped"));
  for (const auto& shown : profiles_in(design)) print_samples(shown);
  print_ranking(design.at("ranking"));
  print_ways_out(design);
  std::fflush(stdout);
  if (const auto message = text_in(design, "message"); !message.empty()) print_notice(message);
}

}  // namespace

std::vector<nlohmann::json> designs_in(const nlohmann::json& answer) {
  if (const auto regions = answer.find("regions"); regions != answer.end())
    return regions->get<std::vector<nlohmann::json>>();
  return {answer};
}

bool misses_target(const nlohmann::json& design) {
  const auto grade = text_in(design.at("verdict"), "grade");
  return grade == "missed" || grade == "unknown";
}

std::vector<std::size_t> worst_first(const std::vector<nlohmann::json>& designs) {
  std::vector<std::size_t> order(designs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return badness(designs[a]) > badness(designs[b]); });
  return order;
}

std::string region_words(const nlohmann::json& design, std::size_t index) {
  return design.contains("name") ? text_in(design, "name") : fmt::format("region {}", index + 1);
}

std::vector<nlohmann::json> profiles_in(const nlohmann::json& design) {
  std::vector<nlohmann::json> profiles{design.at("profile")};
  for (const auto& further : design.at("also")) profiles.push_back(further);
  return profiles;
}

nlohmann::json nearest_possible(const nlohmann::json& profile) {
  const auto bound = profile.find("bound");
  if (bound == profile.end() || bound->is_null()) return nullptr;
  const auto& together = bound->at("together");
  return together.is_null() ? *bound : together;
}

std::string numbered_file(const std::string& file, std::size_t index, std::size_t count) {
  if (count == 1 || file == "-") return file;
  const std::filesystem::path path(file);
  return (path.parent_path() / fmt::format("{}-{}{}", path.stem().string(), index + 1, path.extension().string()))
      .string();
}

std::string designs_as_csv(const nlohmann::json& answer) {
  std::string text =
      "region,profile,task,x,target,achieved,error_bar,initial,verified,lower,upper,reached,in_range,bound\n";
  const auto designs = designs_in(answer);
  for (std::size_t r = 0; r < designs.size(); ++r) {
    const auto profiles = profiles_in(designs[r]);
    for (std::size_t p = 0; p < profiles.size(); ++p) {
      const auto& profile = profiles[p];
      const auto& envelope = profile.at("envelope");
      for (std::size_t i = 0; i < profile.at("x").size(); ++i) {
        text += fmt::format("{},{},{}", r, p, text_in(profile, "task"));
        for (const char* name : {"x", "target", "achieved"}) text += ',' + cell_text(profile.at(name)[i]);
        text += ',' + cell_text(error_bar_at(profile, i)) + ',' + cell_text(profile.at("initial")[i]);
        text += ',' + cell_text(verified_at(profile, profile.at("x")[i]).value_or(nullptr));
        for (const char* name : {"lower", "upper"})
          text += ',' + (envelope.is_null() ? "" : cell_text(envelope.at(name)[i]));
        for (const char* name : {"reached", "in_range"}) text += ',' + cell_text(profile.at(name)[i]);
        const auto bound = nearest_possible(profile);
        text += ',' + (bound.is_null() ? "" : cell_text(bound.at("y")[i])) + '\n';
      }
    }
  }
  return text;
}

void print_designs(const nlohmann::json& answer) {
  bool first = true;
  const auto designs = designs_in(answer);
  if (designs.size() > 1) {
    const std::size_t worst = worst_first(designs).front();
    fmt::print("The worst of {} regions is {}: ", designs.size(), region_words(designs[worst], worst));
    print_verdict(designs[worst].at("verdict"));
    fmt::print("\n");
  }
  for (const auto& design : designs) {
    if (!first) fmt::print("\n");
    print_design(design);
    first = false;
  }
  const auto& accuracy = answer.at("accuracy");
  fmt::print("residual    {:.1e} (asked for {:.1e})\n", accuracy.at("residual").get<double>(),
             accuracy.at("equilibrium_tolerance").get<double>());
  print_cost(answer);
}

std::string profile_as_csv(const nlohmann::json& answer) {
  std::string text = "x,y,error_bar,in_range\n";
  for (std::size_t i = 0; i < answer.at("x").size(); ++i) {
    text += cell_text(answer.at("x")[i]) + ',' + cell_text(answer.at("y")[i]) + ',' +
            cell_text(error_bar_at(answer, i)) + ',' + cell_text(answer.at("in_range")[i]) + '\n';
  }
  return text;
}

void print_profile(const nlohmann::json& answer) {
  const bool poisson = answer.at("task") == "poisson";
  const char* const y = poisson ? "Poisson" : answer.at("task") == "stiffness" ? "stiffness/MPa" : "stress/MPa";
  fmt::print("{}\n{:>10}  {:>13}  {:>9}  {}\n", kind_text(answer), x_heading(answer), y, "error bar", "in range");
  for (std::size_t i = 0; i < answer.at("x").size(); ++i) {
    fmt::print("{:>10}  {:>13}  {:>9}  {}\n", with_decimals(answer.at("x")[i].get<double>()),
               rounded(answer.at("y")[i], scale_of(answer.at("y"))),
               error_bar_text(error_bar_at(answer, i), scale_of(answer.at("y"))),
               answer.at("in_range")[i].get<bool>() ? "yes" : "no");
  }
  fmt::print("model       {}\n", text_in(answer, "model"));
  print_cost(answer);
}

}  // namespace supple::cli
