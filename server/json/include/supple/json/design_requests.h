#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/design/inverse_design.h"
#include "supple/design/verified_designs.h"
#include "supple/json/limits.h"

/// The requests of inverse design as types; they are read like those of requests.h and throw the same. Whether targets
/// make sense and parameters fit the family is not asked here.
namespace supple::json {

/// What a structure may be made of.
struct MaterialSpec {
  std::string where;               ///< its place in its region: "material" or "material/3"
  std::string name;                ///< empty where it has none
  design::Range youngs_modulus{};  ///< MPa; none: that of the model
  bool has_modulus = false;
  std::optional<double> poisson_ratio;  ///< none: that of the model
  bool is_neo_hookean = true;           ///< the law
  double density = 1.2;                 ///< g/cm^3
};

/// What one design is to do, and where to look.
struct RegionSpec {
  std::string name;            ///< empty where it has none
  std::string family = "any";  ///< or "any"
  std::string model;           ///< instead of a family; empty where it is not given
  /// Without the moduli of materials that leave them to the model.
  design::DesignProblem problem;
  std::vector<MaterialSpec> materials;  ///< empty where the request has none
  double beam_width = 0.3;              ///< mm; does not count where there is a cell size
  double cell_size = 0;                 ///< mm, or 0
};

struct DesignRequest {
  bool several = false;             ///< "regions" rather than one problem
  std::vector<RegionSpec> regions;  ///< at least one
  bool verify = false;
  design::VerificationPlan verification;
  design::DesignOptions options;
  std::string session;  ///< empty where it is not given
  double deadline = 0;  ///< seconds; set also where the request leaves it out

  /// Whether designs are simulated: because the request says so, or because they are to be polished at all events.
  bool simulates() const { return verify || verification.polish == Switch::on; }
};
DesignRequest parse_design(std::string_view body, const Limits& limits);

struct ProfileRequest {
  std::string family;  ///< exactly one of family and model is not empty
  std::string model;
  std::vector<double> parameters;
  design::ProfileSamples samples;
  std::optional<MaterialSpec> material;
  double equilibrium_tolerance = 1e-10;
  double deadline = 0;
};
ProfileRequest parse_profile(std::string_view body, const Limits& limits);

}  // namespace supple::json
