#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "supple/neural/network.h"
#include "supple/neural/packed_matrix.h"

namespace supple::neural {

/// What of a network depends on the tiling parameters alone, with derivatives by each of them, in double precision.
/// Vectors beside a matrix of the same name with `_by` are its derivatives, a column (or an entry) for each parameter.
struct DesignContent {
  Eigen::MatrixXd input;    ///< M, width x 3: first layer of the strain branch as a map of e
  Eigen::VectorXd meeting;  ///< width: what the parameter branch and the bias add to the first trunk layer
  Eigen::VectorXd rest;     ///< N(p, 0)
  /// K, what r has beside N(p, e) - N(p, 0): its k-th row times e is added to the k-th residual. y = A e alone in three
  /// rows; with the exact form of rest A e - N'(p, 0) e in as many as there are residuals; none for softplus.
  Eigen::MatrixXd linear;
  double stiffness = 1;  ///< s, MPa; 1 for softplus
  std::vector<Eigen::MatrixXd> input_by;
  Eigen::MatrixXd meeting_by;  ///< width x parameters
  Eigen::MatrixXd rest_by;     ///< outputs x parameters
  std::vector<Eigen::MatrixXd> linear_by;
  Eigen::VectorXd stiffness_by;
};

/// f, f' and f'' of an activation.
struct ActivationAt {
  double value = 0;
  double slope = 0;
  double curvature = 0;
};
ActivationAt activation_at(Activation activation, double z);

/// The layers that see a design's parameters, packed for products with few columns.
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
  /// N(p, 0) and N'(p, 0) e from the meeting layer's sum at rest; the latter is taken from the content's linear part.
  void take_slope_at_rest(const NetworkShape& shape, const Eigen::MatrixXd& meeting, DesignContent& content) const;

  std::vector<Layer> stiffness_;
  std::vector<Layer> parameter_;
  std::vector<Layer> trunk_;        ///< of the first, the columns that see the parameter branch
  Eigen::VectorXd strain_at_rest_;  ///< the strain branch's part of the first trunk layer, which no parameter changes
  /// Its derivative by what the strain branch reads, (y, e) or e; empty unless the network's form of rest is exact.
  Eigen::MatrixXd strain_slope_;
};

}  // namespace supple::neural
