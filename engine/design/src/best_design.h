#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "search_problem.h"

namespace supple::design {

/// The best design of a search so far. Designs are compared by their merit sqrt(d^2 + u^2); see DesignOptions::trust.
class BestDesign {
 public:
  /// The arguments must outlive the object.
  BestDesign(const SearchProblem& problem, SearchCounts& counts) : problem_(problem), counts_(counts) {}

  /// Computes the profiles of the free parameters x from rest, and keeps the design if its merit is the best so far.
  /// Returns the relative root mean square deviation; infinite if an equilibrium is missing.
  double compare(const Eigen::VectorXd& x, DesignTermination stopped);

  bool is_found() const { return found_; }
  /// Whether the model's error bars are long at the design.
  bool is_uncertain() const { return is_uncertain_; }
  /// Whether the design needs no further starting points.
  bool is_good() const;
  double merit() const { return merit_; }
  /// Least deviation of all designs that were compared, trusted or not.
  double min_deviation() const { return min_deviation_; }
  /// All parameters of the design.
  Eigen::VectorXd parameters() const { return FreeParameters::all_of(best_.parameters, best_.orientation); }
  /// The design without its counts, its message and its initial profiles. Throws "design.beyond_limits" or
  /// "design.no_equilibrium" if there is none.
  const Design& get() const;

 private:
  bool keep_if_beyond_limits(const Eigen::VectorXd& parameters, double deviation);
  void replace(const TargetResiduals& residuals, double deviation, DesignTermination stopped,
               std::vector<ProfileTrust> trusts);

  const SearchProblem& problem_;
  SearchCounts& counts_;
  Design best_;
  bool found_ = false;
  bool is_uncertain_ = false;
  double merit_ = 0;
  double min_deviation_ = std::numeric_limits<double>::infinity();
  /// Violated limits of the design with the least deviation beyond the limits, and its deviation.
  std::optional<std::string> beyond_limits_;
  double deviation_beyond_limits_ = 0;
};

}  // namespace supple::design
