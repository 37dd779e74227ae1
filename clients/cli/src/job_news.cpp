#include "job_news.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace supple::cli {
namespace {

std::string as_percent(double deviation) { return fmt::format("{:.3g} %", 100 * deviation); }

}  // namespace

std::string stage_of(const nlohmann::json& job) {
  if (job.at("state") != "running") return "waiting";
  auto stage = job.at("stage").get<std::string>();
  const auto partial = job.find("partial");
  if (partial == job.end()) return stage;
  if (partial->contains("gradient_norm"))
    return stage + fmt::format("  iteration {}, |gradient| {:.2g}", partial->at("iteration").get<int>(),
                               partial->at("gradient_norm").get<double>());
  if (partial->contains("errors")) {
    const auto& reached = partial->at("errors").back();
    return stage + fmt::format("  errs by {} in the mean, {} designs", as_percent(reached.at("error").get<double>()),
                               reached.at("designs").get<long>());
  }
  if (partial->contains("state"))
    return stage + fmt::format("  state {} of {}, strain up to {}", partial->at("number").get<int>(),
                               partial->at("states").get<int>(),
                               as_percent(partial->at("state").at("largest_strain").get<double>()));
  if (partial->contains("round") || partial->contains("error")) {
    const bool is_polishing = partial->contains("round");
    const auto error = is_polishing ? partial->at("round").at("target_error") : partial->at("error").at("relative_rms");
    if (error.is_number())
      stage += fmt::format("  {} {} {}", partial->at("family").get<std::string>(),
                           is_polishing ? "simulated, off by" : "by the model off by", as_percent(error.get<double>()));
  }
  return stage;
}

std::optional<double> remaining_seconds_of(const nlohmann::json& job) {
  const auto remaining = job.find("remaining_seconds");
  if (remaining == job.end() || !remaining->is_number()) return std::nullopt;
  return remaining->get<double>();
}

PolishRounds::Region& PolishRounds::region_named(const std::string& name) {
  const auto known =
      std::find_if(regions_.begin(), regions_.end(), [&name](const Region& region) { return region.name == name; });
  // Regions without a name are told apart by the searches between them.
  if (known != regions_.end() && (!name.empty() || !searches_)) return name.empty() ? regions_.back() : *known;
  regions_.push_back({name, std::numeric_limits<double>::infinity()});
  return regions_.back();
}

std::string PolishRounds::add(const nlohmann::json& job) {
  const auto partial = job.find("partial");
  if (partial == job.end()) return {};
  if (!partial->contains("round")) {
    searches_ = searches_ || partial->contains("error");
    return {};
  }
  if (*partial == latest_) return {};
  latest_ = *partial;
  const auto name = partial->value("name", "");
  Region& region = region_named(name);
  searches_ = false;
  const auto& round = partial->at("round");
  const auto& error = round.at("target_error");
  if (error.is_number()) region.best = std::min(region.best, error.get<double>());
  return fmt::format("{}{} after {:.3g} s{}", name.empty() ? "" : name + ": ",
                     error.is_number() ? as_percent(error.get<double>()) + " off by the simulation" : "not simulated",
                     round.at("seconds").get<double>(),
                     region.best < std::numeric_limits<double>::infinity() ? ", best " + as_percent(region.best) : "");
}

std::string PolishRounds::best() const {
  const auto worst = std::max_element(regions_.begin(), regions_.end(),
                                      [](const Region& a, const Region& b) { return a.best < b.best; });
  if (worst == regions_.end() || !(worst->best < std::numeric_limits<double>::infinity())) return {};
  if (regions_.size() == 1) return "best " + as_percent(worst->best);
  const auto name = worst->name.empty() ? fmt::format("region {}", worst - regions_.begin() + 1) : worst->name;
  return fmt::format("worst: {}, best {}", name, as_percent(worst->best));
}

}  // namespace supple::cli
