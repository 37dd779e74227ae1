#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/design/inverse_design.h"
#include "supple/design/verified_designs.h"
#include "supple/json/limits.h"
#include "supple/json/name_table.h"

/// The requests of inverse design as types; they are read like those of requests.h and throw the same. Whether targets
/// make sense and parameters fit the family is not checked here.
namespace supple::json {

inline constexpr auto task_names = names_of<design::Task>({{design::Task::stress_strain, "stress_strain"},
                                                           {design::Task::stiffness, "stiffness"},
                                                           {design::Task::poisson, "poisson"}});
inline constexpr auto strain_measure_names = names_of<design::StrainMeasure>(
    {{design::StrainMeasure::green, "green"}, {design::StrainMeasure::engineering, "engineering"}});
inline constexpr auto interpolation_names =
    names_of<numerics::Interpolation>({{numerics::Interpolation::cubic, "cubic"},
                                       {numerics::Interpolation::monotone, "monotone"},
                                       {numerics::Interpolation::linear, "linear"}});

/// A material that a structure may be made of.
struct MaterialSpec {
  std::string where;               ///< pointer within its region: "material" or "material/3"
  std::string name;                ///< empty where it has none
  design::Range youngs_modulus{};  ///< MPa; none: that of the model
  bool has_modulus = false;
  std::optional<double> poisson_ratio;  ///< none: that of the model
  bool is_neo_hookean = true;           ///< the law
  double density = 1.2;                 ///< g/cm^3
};

/// The targets of one design, and where to search for it.
struct RegionSpec {
  std::string name;            ///< empty where it has none
  std::string family = "any";  ///< id of the family, or "any"
  std::string model;           ///< id of the model, given instead of a family; empty where it is not given
  /// The problem, without the moduli that are left to the model.
  design::DesignProblem problem;
  std::vector<MaterialSpec> materials;  ///< empty where the request has none
  double beam_width = 0.3;              ///< mm; not used where there is a cell size
  double cell_size = 0;                 ///< mm; 0 where it is not given
};

struct DesignRequest {
  bool several = false;             ///< whether the request has "regions"
  std::vector<RegionSpec> regions;  ///< at least one
  bool verify = false;
  design::VerificationPlan verification;
  design::DesignOptions options;
  Switch beam_width_sensitivity = Switch::automatic;
  Switch ways_out = Switch::automatic;  ///< whether ways out of a missed target are sought
  std::string session;                  ///< empty where it is not given
  double deadline = 0;                  ///< seconds; set also where the request leaves it out

  /// Whether designs are simulated: the request asks for it, or switches their polish on.
  bool simulates() const { return verify || verification.polish == Switch::on; }
  /// Whether structures are simulated at all.
  bool needs_simulations() const { return simulates() || beam_width_sensitivity == Switch::on; }
  /// Whether ways out are sought where the target is missed. An editing session asks anew with every move.
  bool seeks_ways_out() const { return ways_out == Switch::on || (ways_out == Switch::automatic && session.empty()); }
};
DesignRequest parse_design(std::string_view body, const Limits& limits, const CancellationToken& cancellation = {});

struct ProfileRequest {
  std::string family;  ///< exactly one of family and model is not empty
  std::string model;
  std::vector<double> parameters;
  design::ProfileSamples samples;
  std::optional<MaterialSpec> material;
  double equilibrium_tolerance = 1e-10;
  double deadline = 0;
};
ProfileRequest parse_profile(std::string_view body, const Limits& limits, const CancellationToken& cancellation = {});

}  // namespace supple::json
