#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace supple::neural {

/// The quantity to which an error bar belongs. The load is uniaxial along d, and n is orthogonal to d. All error bars
/// except that of Poisson's ratio are relative to the network's own value.
enum class Quantity {
  stress,            ///< d^T S d
  stiffness,         ///< d(d^T S d) / d(d^T E d) along the loading path
  poisson,           ///< -d(n^T E n) / d(d^T E d) along the loading path; the bar is an absolute difference
  stress_at_strain,  ///< (S_xx, S_yy, S_xy) at a given strain, in the Euclidean norm
};
inline constexpr std::array<Quantity, 4> all_quantities{Quantity::stress, Quantity::stiffness, Quantity::poisson,
                                                        Quantity::stress_at_strain};
std::string_view to_string(Quantity quantity);

/// A state whose error bar is above this limit is not `in_range`: 5 % for a stress under a uniaxial load, 10 % for a
/// stiffness or for the stress at a given strain, and 0.1 for Poisson's ratio. The largest error of a uniaxial stress
/// published is 3.57 % [Thesis, sec. 4.4.1]. Errors of tangents are several times as large.
double max_trusted_error(Quantity quantity);

/// A validation of error bars with states of designs that were not used to make the bars.
struct BarCoverage {
  std::int64_t designs = 0;
  std::int64_t states = 0;
  double share = 0;              ///< fraction of the states whose error is within its bar
  double median_bar = 0;         ///< median of the bars
  std::vector<double> stated;    ///< states ordered by their bars, in ten equal groups: the median bar of each group
  std::vector<double> observed;  ///< fraction of each of these groups whose error is within its bar
  // Counts of states whose error, relative to the simulation, exceeds the largest one in [Thesis], 3.57 % (0.0357 for
  // Poisson's ratio):
  std::int64_t beyond = 0;
  std::int64_t beyond_in_box = 0;    ///< those of them that are within the ranges of training
  std::int64_t beyond_in_range = 0;  ///< those in the box whose bar is at most max_trusted_error
  // The same counts for the other states:
  std::int64_t within = 0;
  std::int64_t within_in_box = 0;
  std::int64_t within_in_range = 0;
};

/// The offset that is added to the rating of a state. It is such that, among states of this rating, the fraction
/// Calibration::level of the errors is below the sum.
struct BarOffsets {
  std::vector<double> knots;    ///< ratings, increasing
  std::vector<double> offsets;  ///< offsets at the knots; they are linear between knots and constant beyond
  BarCoverage judged;

  double at(double rating) const;
};

/// How a design was chosen.
enum class Origin {
  given,     ///< it was given by a user, or drawn at random
  searched,  ///< an optimization over the network's predictions has found it
};

/// The model of the errors of one quantity: log(error + floor) is the sum of a rating and an offset. The rating is a
/// polynomial of degree 2 in features of the state.
struct ErrorScale {
  // Features are first clamped to the range of the calibration's states.
  Eigen::VectorXd least;
  Eigen::VectorXd greatest;
  // Then they are scaled to mean 0 and standard deviation 1.
  Eigen::VectorXd mean;
  Eigen::VectorXd deviation;
  Eigen::VectorXd coefficients;  ///< one for each of quadratic_terms
  BarOffsets given;              ///< offsets of designs of Origin::given
  /// Offsets of designs of Origin::searched. A search prefers designs for which the network predicts the wanted
  /// properties, whether or not it is right. Their errors are therefore distributed differently from those of given
  /// designs with the same rating. Empty if no such designs were simulated; they then have the offsets `given`.
  BarOffsets searched;

  const BarOffsets& of(Origin origin) const {
    return origin == Origin::searched && !searched.knots.empty() ? searched : given;
  }
};

/// The error bars of a model: split conformal prediction [Vovk2005] on designs that were not used for training (see
/// training::calibrate).
struct Calibration {
  double level = 0.9;   ///< fraction of the errors that are below their bar
  double floor = 5e-4;  ///< errors far below this are not distinguished
  /// Whether the bars were made and validated with new designs, whose simulations are free of the discretization error
  /// of the training data. Otherwise that was done with designs of the data set that were not used for training, whose
  /// simulations have that error.
  bool by_fresh_designs = false;
  std::array<ErrorScale, 4> scales;  ///< one for each of all_quantities, in their order

  const ErrorScale& of(Quantity quantity) const { return scales[static_cast<std::size_t>(quantity)]; }
};

/// Larger errors are replaced by this number, so that no bar is longer.
inline constexpr double largest_error = 10;

/// The terms (1, z_i, z_i z_j for i <= j) of a polynomial of degree 2: 1 + n + n (n + 1) / 2 numbers.
Eigen::VectorXd quadratic_terms(const Eigen::VectorXd& z);

/// The features z: clamped to the limits of the scale, and scaled to mean 0 and standard deviation 1.
Eigen::VectorXd normalized(const ErrorScale& scale, const Eigen::VectorXd& features);

/// The rating of a state with these features: the predicted log(error + floor) without the offset.
double rating(const ErrorScale& scale, const Eigen::VectorXd& features);

/// The error bar of a state whose rating and offset have the sum `logarithm`. It is between 0 and largest_error.
double bar_of(const Calibration& calibration, double logarithm);

/// The error bar at features as in error_features.h: the fraction Calibration::level of the errors is below it. It is
/// finite, and between 0 and largest_error. Takes O(n^2) for n features, which is half a microsecond.
double expected_error(const Calibration& calibration, Quantity quantity, const Eigen::VectorXd& features,
                      Origin origin = Origin::given);

}  // namespace supple::neural
