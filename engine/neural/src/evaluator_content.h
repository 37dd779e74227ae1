#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "design_content.h"
#include "supple/neural/network.h"
#include "supple/neural/packed_matrix.h"

// What an evaluator, a design and a workspace hold, in the order in which the passes read it.
namespace supple::neural {

/// A layer's weights in both directions. The first layers need the way back only, which depends on the design.
template <class Real>
struct PackedLayer {
  PackedMatrix<Real> forward;
  PackedMatrix<Real> backward;
  std::vector<Real> bias;  ///< zeros below, up to a stride

  PackedLayer(const Eigen::Ref<const Eigen::MatrixXd>& weights, const Eigen::VectorXd& bias_values);
};

/// A network's numbers.
template <class Real>
struct PackedNetwork {
  explicit PackedNetwork(const Network& of);

  Network network;
  DesignLayers design_layers;
  std::vector<Real> first_bias;
  /// Of the layers between the first of the strain branch and the last of the trunk: the hidden ones, in order.
  std::vector<PackedLayer<Real>> hidden;
  PackedLayer<Real> last;

  /// Index in `hidden` of the layer where the branches meet.
  std::size_t meeting() const { return network.strain.size() - 1; }
};

/// What depends on the tiling parameters alone.
template <class Real>
struct PackedDesign {
  PackedDesign() = default;
  PackedDesign(const PackedNetwork<Real>& of, std::span<const double> parameters, bool with_parameter_derivatives);

  DesignContent exact;
  bool with_derivatives = false;
  PackedMatrix<Real> input;         ///< M
  PackedMatrix<Real> input_back;    ///< rows: M^T, then for each parameter the three rows of its derivative
  PackedMatrix<Real> meeting_back;  ///< rows: derivative of the meeting layer's addend by each parameter
  std::vector<Real> meeting;
};

/// Scratch space of a pass; jets of one block of strains.
template <class Real>
struct PassSpace {
  std::vector<Real> strains;
  std::vector<std::vector<Real>> slopes;  ///< of each activation, jets of f'
  std::vector<Real> activations;
  std::vector<Real> products;
  std::vector<Real> outputs;
  std::vector<Real> small;
  Eigen::ArrayXXd energy;  ///< channels x jets
};

}  // namespace supple::neural
