#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

// What a job that runs tells about itself.
namespace supple::cli {

/// The stage of a job and, if the job reports it, how far the best design so far is from its target, or a network from
/// its equilibrium. Jobs may report other things, which are ignored.
std::string stage_of(const nlohmann::json& job);

/// The seconds until a job ends, where the server can tell.
std::optional<double> remaining_seconds_of(const nlohmann::json& job);

/// The rounds of a job that polishes designs, as its polls report them. A job reports its latest round only, and
/// polishes its regions one after the other.
class PolishRounds {
 public:
  /// Takes in the description of a job. Returns the round in words if it is a new one, otherwise an empty text.
  std::string add(const nlohmann::json& job);

  /// The best deviation so far of the region that is furthest from its target; it names the region if there are
  /// several. Empty before the first round with a result.
  std::string best() const;

 private:
  struct Region {
    std::string name;  ///< may be empty
    double best;       ///< least simulated deviation of its rounds, infinite before there is one
  };

  Region& region_named(const std::string& name);

  std::vector<Region> regions_;
  bool searches_ = false;  ///< whether the job has reported a search since the latest round
  nlohmann::json latest_;
};

}  // namespace supple::cli
