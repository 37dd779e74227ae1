#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "design_content.h"
#include "supple/neural/network.h"
#include "supple/neural/packed_matrix.h"

// The numbers of an evaluator, a design and a workspace, in the order in which the passes read them.
namespace supple::neural {

/// The weights of a layer for the forward and the backward pass.
template <class Real>
struct PackedLayer {
  PackedMatrix<Real> forward;
  PackedMatrix<Real> backward;
  std::vector<Real> bias;  ///< padded with zeros to padded_rows

  PackedLayer(const Eigen::Ref<const Eigen::MatrixXd>& weights, const Eigen::VectorXd& bias_values);
};

/// The packed weights of a network.
template <class Real>
struct PackedNetwork {
  explicit PackedNetwork(const Network& of);

  Network network;
  DesignLayers design_layers;
  std::vector<Real> first_bias;
  /// The layers between the first one of the strain branch and the last one of the trunk, in order.
  std::vector<PackedLayer<Real>> hidden;
  PackedLayer<Real> last;

  /// Index in `hidden` of the first trunk layer, which reads both branches.
  std::size_t first_trunk_layer() const { return network.strain.size() - 1; }
};

/// The packed quantities of a design, which depend on the tiling parameters alone.
template <class Real>
struct PackedDesign {
  PackedDesign() = default;
  PackedDesign(const PackedNetwork<Real>& of, std::span<const double> parameters, bool with_parameter_derivatives);

  DesignContent exact;
  bool with_derivatives = false;
  PackedMatrix<Real> input;            ///< DesignContent::input
  PackedMatrix<Real> input_back;       ///< the transposed input, and below it that of each of its derivatives
  PackedMatrix<Real> trunk_bias_back;  ///< the derivative of the trunk bias with respect to each parameter, as a row
  std::vector<Real> trunk_bias;        ///< padded with zeros
};

/// Scratch memory of a pass for the jets of one block of strains.
template <class Real>
struct PassSpace {
  std::vector<Real> strains;
  std::vector<std::vector<Real>> slopes;  ///< jets of f' for each activation
  std::vector<Real> activations;
  std::vector<Real> products;
  std::vector<Real> outputs;
  std::vector<Real> design_products;  ///< products with input_back or trunk_bias_back
  Eigen::ArrayXXd energy;             ///< channels x jets
};

}  // namespace supple::neural
