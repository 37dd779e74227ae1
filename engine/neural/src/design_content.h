#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "supple/neural/network.h"
#include "supple/neural/packed_matrix.h"

namespace supple::neural {

/// The quantities of a network that depend on the tiling parameters p alone, in double precision. Members whose names
/// end in `_by` are derivatives with respect to each parameter: a column, an entry, or an element of a vector. The
/// notation is that of EnergyForm.
struct DesignContent {
  Eigen::MatrixXd input;       ///< width x 3: the first layer of the strain branch as a linear map of e
  Eigen::VectorXd trunk_bias;  ///< width: the first trunk layer's bias and its product with the parameter branch
  Eigen::VectorXd rest;        ///< N(p, 0)
  /// The residuals r are N(p, e) - N(p, 0) + linear e. With RestForm::free, `linear` is A = L^T / sqrt(s), for the
  /// first three residuals. With RestForm::exact, it is A - N'(p, 0), for all residuals. It is empty for softplus.
  Eigen::MatrixXd linear;
  double stiffness = 1;  ///< s, MPa; 1 for softplus
  std::vector<Eigen::MatrixXd> input_by;
  Eigen::MatrixXd trunk_bias_by;  ///< width x parameters
  Eigen::MatrixXd rest_by;        ///< outputs x parameters
  std::vector<Eigen::MatrixXd> linear_by;
  Eigen::VectorXd stiffness_by;
};

/// An activation and its first two derivatives at a number.
struct ActivationAt {
  double value = 0;
  double slope = 0;
  double curvature = 0;
};
ActivationAt activation_at(Activation activation, double z);

/// The layers that depend on a design's parameters, packed for products with few columns.
class DesignLayers {
 public:
  explicit DesignLayers(const Network& network);

  /// Evaluates the parameter and stiffness branches, and the trunk at rest. `network` is the one that was packed.
  DesignContent evaluate(const Network& network, std::span<const double> parameters, bool with_derivatives) const;

 private:
  struct Layer {
    PackedMatrix<double> weights;
    Eigen::VectorXd bias;
    Eigen::MatrixXd operator()(const Eigen::MatrixXd& x) const;
  };
  /// Computes N(p, 0), and subtracts N'(p, 0) from `content.linear`. `trunk_sum` is the input of the first trunk
  /// layer's activation at rest, with its derivatives with respect to the parameters.
  void subtract_rest_slope(const NetworkShape& shape, const Eigen::MatrixXd& trunk_sum, DesignContent& content) const;

  std::vector<Layer> stiffness_;
  std::vector<Layer> parameter_;
  std::vector<Layer> trunk_;  ///< the first one has only the columns that read the parameter branch
  /// The first trunk layer's product with the strain branch at rest. It does not depend on parameters.
  Eigen::VectorXd strain_at_rest_;
  /// Its derivative with respect to the input of the strain branch, (y, e); empty unless the network has
  /// RestForm::exact.
  Eigen::MatrixXd strain_slope_;
};

}  // namespace supple::neural
