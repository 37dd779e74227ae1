#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>
#include <vector>

#include "supple/neural/tile_features.h"

namespace supple::neural {

/// The activation function of every hidden layer: z sigmoid(z), tanh z or sin z.
enum class Activation { swish, tanh, sine };
std::string_view to_string(Activation activation);
/// Throws "model.unknown_activation", which lists the known ones.
Activation activation_of(std::string_view name);

/// How the last layer's outputs N become an energy density.
///
/// Throughout, p are the tiling parameters, mapped linearly from their bounds to [-1, 1], e = (E_xx, E_yy, 2 E_xy) is
/// the Green strain, L(p) the lower triangular factor that the stiffness branch returns, s = tr(L L^T) / 3 a stiffness
/// in MPa, and y = L^T e / sqrt(s) the strain measured by its energy.
enum class EnergyForm {
  /// Phi = s/2 sum_k r_k^2 with r_k = N_k(p, e) - N_k(p, 0) + y_k, where y_k = 0 for k > 3. Energy and stress vanish at
  /// rest, energies are never negative, and stiffnesses that span decades span half as many in what is learned.
  sum_of_squares,
  /// Phi = softplus(N(p, e)) as in the thesis (4.3.4): one output, no stiffness branch.
  softplus,
};
std::string_view to_string(EnergyForm form);
EnergyForm energy_form_of(std::string_view name);

/// What determines the stiffness at rest in the sum of squares.
enum class RestForm {
  /// The residuals are those above, so that the slope N'(p, 0) adds to L^T / sqrt(s).
  free,
  /// r_k = N_k(p, e) - N_k(p, 0) - N_k'(p, 0) e + y_k: the Hessian of Phi at rest is L L^T and nothing else, so that a
  /// better L is a better stiffness.
  exact,
};
std::string_view to_string(RestForm form);
/// Throws "model.unknown_form", which lists the known ones.
RestForm rest_form_of(std::string_view name);

struct NetworkShape {
  int parameters = 1;        ///< 1 to max_parameters
  int width = 256;           ///< neurons of each hidden layer; a multiple of 8
  int strain_layers = 3;     ///< layers of the branch that reads the strain
  int parameter_layers = 3;  ///< layers of the branch that reads the parameters
  int trunk_layers = 5;      ///< hidden layers after both branches meet
  int residuals = 8;         ///< outputs of the sum of squares, at least 3; softplus has one output
  int stiffness_width = 64;  ///< neurons of each hidden layer of the stiffness branch
  int stiffness_layers = 2;  ///< hidden layers of the stiffness branch
  int features = 0;          ///< features of the tile, which the parameter and stiffness branches read too
  Activation activation = Activation::swish;
  EnergyForm form = EnergyForm::sum_of_squares;
  RestForm rest = RestForm::free;

  bool operator==(const NetworkShape&) const = default;
  int outputs() const { return form == EnergyForm::softplus ? 1 : residuals; }
  /// What the first layer of the strain branch reads: (y, e), or e alone.
  int strain_inputs() const { return form == EnergyForm::softplus ? 3 : 6; }
  /// What the first layers of the parameter and stiffness branches read: parameters, then features.
  int design_inputs() const { return parameters + features; }
};
inline constexpr int max_parameters = 8;

/// x -> weights x + bias; rows are outputs.
struct Layer {
  Eigen::MatrixXd weights;
  Eigen::VectorXd bias;
};

/// A smooth energy density of strain and tiling parameters: the two-branch network of the thesis (4.3.4), as plain
/// numbers. Its first trunk layer reads (strain branch, parameter branch); the last layer of `trunk` and of `stiffness`
/// is linear. The stiffness branch returns (log L11, log L22, log L33, L21/L11, L31/L11, L32/L22) of L in sqrt(MPa),
/// and has a swish in its hidden layers.
struct Network {
  NetworkShape shape;
  Eigen::VectorXd lower;  ///< lower bounds of the parameters, which are mapped to -1
  Eigen::VectorXd upper;  ///< upper bounds, which are mapped to +1
  std::vector<Layer> strain;
  std::vector<Layer> parameter;
  std::vector<Layer> trunk;
  std::vector<Layer> stiffness;  ///< empty for softplus
  TileGeometry geometry;         ///< the tile and `shape.features` features of it; unused if there are none
  /// Takes off what the mesh of the data errs by: this matrix times (1, p_i, p_i p_j for i <= j), p the mapped
  /// parameters, is added to the outputs of the stiffness branch. It has 6 rows. The first three, half the logarithm of
  /// a factor each, multiply the energy by that factor where they are equal and the others zero. Derivatives stay
  /// exact, because the correction is a part of the network. If it is empty, the network answers as simulations on the
  /// mesh of its data do.
  Eigen::MatrixXd mesh_correction;
  /// Maps T of strains e that do not change the family's energies. They belong to the rotations of the structure onto
  /// itself, without the identity. The energy density is the mean of Phi(p, e) and all Phi(p, T e), so that it has
  /// these symmetries exactly. Each map costs one more evaluation. If the list is empty, the energy density is Phi(p,
  /// e).
  std::vector<Eigen::Matrix3d> symmetries;

  /// Number of weights and biases.
  long weights() const;
};

/// Parameters, mapped linearly from the network's bounds to [-1, 1].
Eigen::VectorXd mapped(const Network& network, std::span<const double> parameters);

/// The network as its data have taught it, without the correction of their mesh. Whoever compares a network with data
/// of that mesh compares this one.
Network as_trained(Network network);

/// Throws "model.invalid_network", which names the layer, unless all sizes fit together and all numbers are finite.
void validate(const Network& network);

}  // namespace supple::neural
