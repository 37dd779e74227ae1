#pragma once

#include <optional>
#include <string>
#include <vector>

#include "supple/design/verified_designs.h"
#include "supple/json/answers.h"
#include "supple/json/design_requests.h"

/// The answers of inverse design as JSON text; they throw like those of answers.h.
namespace supple::json {

/// Which model a design is of.
struct DesignModel {
  std::string family;
  std::string id;
  std::string sha256;
  double youngs_modulus = 0;  ///< of its data, MPa
  double poisson_ratio = 0;   ///< of its data
};

/// One region's answer.
struct FoundDesigns {
  std::vector<DesignModel> models;               ///< of the spaces that were searched
  std::vector<design::VerifiedDesign> ranking;   ///< best first, at least one
  std::optional<design::Polished> verification;  ///< of the first; none where the request does not ask for one
  RegionSpec spec{};                             ///< what was asked for
  std::vector<std::optional<double>> discretization_error{};  ///< as in VerifiedDesigns; empty without verification
};

std::string write_design(const DesignRequest& request, const std::vector<FoundDesigns>& found, const Bill& bill);
/// What the job's events carry while it runs.
std::string write_partial_design(const std::string& name, const DesignModel& model,
                                 const design::DesignProgress& progress);
/// The same for a structure that was simulated.
std::string write_partial_round(const std::string& name, const DesignModel& model, const design::PolishRound& round);
std::string write_profile(const DesignModel& model, const ProfileRequest& request, const design::Profile& profile,
                          const Bill& bill);

}  // namespace supple::json
