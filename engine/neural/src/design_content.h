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
  Eigen::Matrix3d skip;     ///< A with y = A e; zero for softplus
  double stiffness = 1;     ///< s, MPa; 1 for softplus
  std::vector<Eigen::MatrixXd> input_by;
  Eigen::MatrixXd meeting_by;  ///< width x parameters
  Eigen::MatrixXd rest_by;     ///< outputs x parameters
  std::vector<Eigen::Matrix3d> skip_by;
  Eigen::VectorXd stiffness_by;
};

/// f and f' of an activation.
std::pair<double, double> value_and_slope(Activation activation, double z);

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
  std::vector<Layer> stiffness_;
  std::vector<Layer> parameter_;
  std::vector<Layer> trunk_;        ///< of the first, the columns that see the parameter branch
  Eigen::VectorXd strain_at_rest_;  ///< the strain branch's part of the first trunk layer, which no parameter changes
};

}  // namespace supple::neural
