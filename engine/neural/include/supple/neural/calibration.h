#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace supple::neural {

/// The quantity to which an error bar belongs. The load is uniaxial along d, and n is orthogonal to d. All bars except
/// that of Poisson's ratio are relative to the network's own value.
enum class Quantity {
  stress,            ///< d^T S d
  stiffness,         ///< d(d^T S d) / d(d^T E d) along the loading path
  poisson,           ///< -d(n^T E n) / d(d^T E d) along the loading path; the bar is a plain difference
  stress_at_strain,  ///< (S_xx, S_yy, S_xy) at a given strain, in the Euclidean norm
};
inline constexpr std::array<Quantity, 4> all_quantities{Quantity::stress, Quantity::stiffness, Quantity::poisson,
                                                        Quantity::stress_at_strain};
std::string_view to_string(Quantity quantity);

/// A state whose error bar is above this limit is not `in_range`: 5 % for a stress under a uniaxial load, 10 % for a
/// stiffness or for the stress at a given strain, and 0.1 for Poisson's ratio. The thesis's networks err by at most
/// 3.57 % in a uniaxial stress (4.4.3), and tangents err several times as much.
double trusted_error(Quantity quantity);

/// How well error bars hold, judged by states of designs that had no part in making them.
struct JudgedBars {
  std::int64_t designs = 0;
  std::int64_t states = 0;
  double share = 0;              ///< share of the states whose error is within the bar
  double median_bar = 0;         ///< median of the stated bars
  std::vector<double> stated;    ///< median bar of each tenth of the states, which are ordered by their bars
  std::vector<double> observed;  ///< share of that tenth whose error is within the bar
  // Numbers of states whose error, relative to the simulation, exceeds the thesis's worst of 3.57 % (0.0357 for
  // Poisson's ratio):
  std::int64_t beyond = 0;
  std::int64_t beyond_in_box = 0;    ///< those of them within the ranges of training
  std::int64_t beyond_in_range = 0;  ///< those of them that are in range according to their bars too
  // The same numbers for the other states:
  std::int64_t within = 0;
  std::int64_t within_in_box = 0;
  std::int64_t within_in_range = 0;
};

/// What is added to the rating of a state, so that the stated share of the errors of states that are rated alike is
/// below the result.
struct BarOffsets {
  std::vector<double> knots;    ///< ratings, increasing
  std::vector<double> offsets;  ///< at the knots; linear between them and constant beyond
  JudgedBars judged;

  double at(double rating) const;
};

/// How a design came to be looked at.
enum class Origin {
  given,     ///< somebody named it, or it was drawn at random
  searched,  ///< a search among the network's answers has found it
};

/// The size of the errors that is to be expected of one quantity: log(error + floor) is a rating, which is a polynomial
/// of degree 2 in features of the state, and an offset.
struct ErrorScale {
  Eigen::VectorXd least;  ///< features are first clamped to the range that was seen
  Eigen::VectorXd greatest;
  Eigen::VectorXd mean;  ///< then they are scaled to mean 0 and deviation 1
  Eigen::VectorXd deviation;
  Eigen::VectorXd coefficients;  ///< one for each of quadratic_terms
  BarOffsets given;              ///< for designs that are given
  /// For designs that a search has found. A search prefers designs of which the network says what is wanted, whether or
  /// not that is true, so that its designs err otherwise than others that are rated alike. Empty if no such designs
  /// were simulated; then they have the offsets of others.
  BarOffsets searched;

  const BarOffsets& of(Origin origin) const {
    return origin == Origin::searched && !searched.knots.empty() ? searched : given;
  }
};

/// Error bars of a model: split conformal prediction on designs that training has not seen (training::calibrate).
struct Calibration {
  double level = 0.9;   ///< share of the errors that are below their bar
  double floor = 5e-4;  ///< errors far below this are not distinguished
  /// Whether fresh designs made and judged the bars, simulated without the error of the data's mesh. Otherwise designs
  /// of the data did that training had not seen, with that error.
  bool by_fresh_designs = false;
  std::array<ErrorScale, 4> scales;  ///< one for each of all_quantities, in their order

  const ErrorScale& of(Quantity quantity) const { return scales[static_cast<std::size_t>(quantity)]; }
};

/// Larger errors are replaced by this number, so that no bar is longer.
inline constexpr double largest_error = 10;

/// The terms (1, z_i, z_i z_j for i <= j) of a polynomial of degree 2: 1 + n + n (n + 1) / 2 numbers.
Eigen::VectorXd quadratic_terms(const Eigen::VectorXd& z);

/// The features z of a scale: clamped to its limits, and scaled to mean 0 and deviation 1.
Eigen::VectorXd normalized(const ErrorScale& scale, const Eigen::VectorXd& features);

/// The rating of a state with these features.
double rating(const ErrorScale& scale, const Eigen::VectorXd& features);

/// The error bar of a state whose rating and offset add up to this logarithm, between 0 and largest_error.
double bar_of(const Calibration& calibration, double logarithm);

/// The error below which the stated share of the answers stays, at features as in error_features.h. It is finite and
/// lies between 0 and largest_error. O(n^2) for n features, which is half a microsecond.
double expected_error(const Calibration& calibration, Quantity quantity, const Eigen::VectorXd& features,
                      Origin origin = Origin::given);

}  // namespace supple::neural
