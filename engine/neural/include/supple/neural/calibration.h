#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace supple::neural {

/// What an error bar is of. Along d under a uniaxial load, n orthogonal to d; all but Poisson's ratio are relative to
/// the network's own value.
enum class Quantity {
  stress,            ///< d^T S d
  stiffness,         ///< d(d^T S d) / d(d^T E d) along the loading path
  poisson,           ///< -d(n^T E n) / d(d^T E d) along the loading path; the plain difference
  stress_at_strain,  ///< (S_xx, S_yy, S_xy) at a given strain, in the Euclidean norm
};
inline constexpr std::array<Quantity, 4> all_quantities{Quantity::stress, Quantity::stiffness, Quantity::poisson,
                                                        Quantity::stress_at_strain};
std::string_view to_string(Quantity quantity);

/// Error bars above this do not say `in_range`: 5 % of a stress under a uniaxial load; 10 % of a stiffness or of the
/// stress at a given strain; 0.1 of a Poisson's ratio. The thesis's networks err by 3.57 % of a uniaxial stress at
/// worst (4.4.3); tangents err several times as much.
double trusted_error(Quantity quantity);

/// What error bars were found to be worth, on states of designs that had no part in them.
struct JudgedBars {
  std::int64_t designs = 0;
  std::int64_t states = 0;
  double share = 0;              ///< of the states that are within their bar
  double median_bar = 0;         ///< as stated
  std::vector<double> stated;    ///< median bar of each tenth of the states, by their bars
  std::vector<double> observed;  ///< share of that tenth within its bars
  // Where the error, relative to the simulation, is beyond the thesis's worst, 3.57 % (of Poisson's ratio 0.0357):
  std::int64_t beyond = 0;
  std::int64_t beyond_in_box = 0;    ///< of them, within the ranges of training
  std::int64_t beyond_in_range = 0;  ///< of them, said to be in range also by their bars
  // Where it is not:
  std::int64_t within = 0;
  std::int64_t within_in_box = 0;
  std::int64_t within_in_range = 0;
};

/// How large the errors of one quantity are to be expected: log(error + floor) by a polynomial of degree 2 of features
/// of the state, to which an offset is added so that the stated share of errors is below.
struct ErrorScale {
  Eigen::VectorXd least;  ///< features are held within what was seen
  Eigen::VectorXd greatest;
  Eigen::VectorXd mean;  ///< then made of mean 0 and deviation 1
  Eigen::VectorXd deviation;
  Eigen::VectorXd coefficients;  ///< of quadratic_terms
  std::vector<double> knots;     ///< values of the polynomial, increasing
  std::vector<double> offsets;   ///< there; linear between them and constant beyond
  JudgedBars judged;
};

/// Error bars of a model: split conformal prediction on designs that training has not seen (training::calibrate).
struct Calibration {
  double level = 0.9;                ///< share of the errors that are below their bar
  double floor = 5e-4;               ///< errors far below it are not told apart
  std::array<ErrorScale, 4> scales;  ///< of all_quantities, in their order

  const ErrorScale& of(Quantity quantity) const { return scales[static_cast<std::size_t>(quantity)]; }
};

/// Errors above are taken for this: no bar is longer.
inline constexpr double largest_error = 10;

/// (1, z_i, z_i z_j for i <= j): 1 + n + n (n + 1) / 2 numbers.
Eigen::VectorXd quadratic_terms(const Eigen::VectorXd& z);

/// The features z of a scale: held within its limits, mean 0, deviation 1.
Eigen::VectorXd normalized(const ErrorScale& scale, const Eigen::VectorXd& features);

/// The offset at a value of the polynomial.
double offset_at(const std::vector<double>& knots, const std::vector<double>& offsets, double score);

/// The error that the stated share of the answers stay below, at features as of error_features.h. Finite, from 0 to
/// largest_error. O(n^2) for n features: half a microsecond.
double expected_error(const Calibration& calibration, Quantity quantity, const Eigen::VectorXd& features);

}  // namespace supple::neural
