#pragma once

#include <optional>
#include <string>
#include <vector>

#include "supple/design/verified_designs.h"
#include "supple/design/ways_out.h"
#include "supple/json/answers.h"
#include "supple/json/design_requests.h"
#include "supple/json/verdict_sentence.h"

/// The answers of inverse design as JSON text; they throw like those of answers.h.
namespace supple::json {

/// The model that a design was found with.
struct DesignModel {
  std::string family;
  std::string id;
  std::string sha256;
  double youngs_modulus = 0;  ///< modulus of the material of its data, MPa
  double poisson_ratio = 0;   ///< Poisson's ratio of the material of its data
};

/// One region's answer.
struct FoundDesigns {
  std::vector<DesignModel> models;               ///< models of the spaces that were searched
  std::vector<design::VerifiedDesign> ranking;   ///< best first, at least one
  std::optional<design::Polished> verification;  ///< verification of the first design; none where not requested
  RegionSpec spec{};                             ///< what the request asks for
  std::vector<std::optional<double>> discretization_error{};  ///< see VerifiedDesigns; empty without verification
  std::vector<design::WayOut> ways_out{};                     ///< best first
  std::vector<DesignModel> other_models{};                    ///< models of the families that `ways_out` may name
  std::vector<design::BeamWidthSensitivity> beam_width_sensitivity{};  ///< see VerifiedDesigns
  BoundedTargets bounded{};  ///< targets, and what any material can have at rest
};

std::string write_design(const DesignRequest& request, const std::vector<FoundDesigns>& found, const Bill& bill);
/// What the events of the job carry while it runs: the design of an iteration.
std::string write_partial_design(const std::string& name, const DesignModel& model,
                                 const design::DesignProgress& progress);
/// The same for a structure that was simulated.
std::string write_partial_round(const std::string& name, const DesignModel& model, const design::PolishRound& round);
std::string write_profile(const DesignModel& model, const ProfileRequest& request, const design::Profile& profile,
                          const Bill& bill);

}  // namespace supple::json
