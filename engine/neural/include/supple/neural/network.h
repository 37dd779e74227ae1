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

/// The form in which the last layer's outputs N give an energy density Phi.
///
/// Here and below, p are the tiling parameters, mapped linearly from their bounds to [-1, 1]; e = (E_xx, E_yy, 2 E_xy)
/// is the Green strain; L(p) is the lower triangular factor of a stiffness, which the stiffness branch returns; s =
/// tr(L L^T) / 3 is the size of that stiffness in MPa; and y = L^T e / sqrt(s) is the strain in the norm of the energy.
enum class EnergyForm {
  /// Phi = s/2 sum_k r_k^2 with r_k = N_k(p, e) - N_k(p, 0) + y_k, where y_k = 0 for k > 3. Energy and stress vanish at
  /// rest, and energies are never negative. The learned factor L spans only half as many decades as the stiffness does.
  sum_of_squares,
  /// Phi = softplus(N(p, e)) as in [Thesis, sec. 4.3.4]. There is one output and no stiffness branch.
  softplus,
};
std::string_view to_string(EnergyForm form);
EnergyForm energy_form_of(std::string_view name);

/// The form of the residuals r_k, which determines the stiffness at rest in the sum of squares.
enum class RestForm {
  /// The residuals are those of EnergyForm, so that the stiffness at rest also depends on the slope N'(p, 0).
  free,
  /// r_k = N_k(p, e) - N_k(p, 0) - N_k'(p, 0) e + y_k. The Hessian of Phi at rest is exactly L L^T, so that the
  /// stiffness
  /// at rest is as accurate as L.
  exact,
};
std::string_view to_string(RestForm form);
/// Throws "model.unknown_form", which lists the known ones.
RestForm rest_form_of(std::string_view name);

/// The sizes and the form of a network.
struct NetworkShape {
  int parameters = 1;        ///< 1 to max_parameters
  int width = 256;           ///< neurons of each hidden layer; a multiple of 8
  int strain_layers = 3;     ///< layers of the branch that reads the strain
  int parameter_layers = 3;  ///< layers of the branch that reads the parameters
  int trunk_layers = 5;      ///< hidden layers after both branches meet
  int residuals = 8;         ///< outputs of the sum of squares, at least 3; softplus has one output
  int stiffness_width = 64;  ///< neurons of each hidden layer of the stiffness branch
  int stiffness_layers = 2;  ///< hidden layers of the stiffness branch
  int features = 0;          ///< number of features of the tile, which the parameter and stiffness branches read too
  Activation activation = Activation::swish;
  EnergyForm form = EnergyForm::sum_of_squares;
  RestForm rest = RestForm::free;

  bool operator==(const NetworkShape&) const = default;
  int outputs() const { return form == EnergyForm::softplus ? 1 : residuals; }
  /// Number of inputs of the strain branch: (y, e), or e alone for softplus.
  int strain_inputs() const { return form == EnergyForm::softplus ? 3 : 6; }
  /// Number of inputs of the parameter and stiffness branches: the parameters, then the features.
  int design_inputs() const { return parameters + features; }
};
inline constexpr int max_parameters = 8;

/// The affine map x -> weights x + bias of one layer. Rows are outputs.
struct Layer {
  Eigen::MatrixXd weights;
  Eigen::VectorXd bias;
};

/// The weights of a network whose output is a smooth energy density, a function of strain and tiling parameters. It has
/// two branches, for the strain and for the parameters, as in [Thesis, sec. 4.3.4]. The first trunk layer reads (strain
/// branch, parameter branch). The last layers of `trunk` and of `stiffness` are linear. The stiffness branch returns
/// (log L11, log L22, log L33, L21/L11, L31/L11, L32/L22) of L in sqrt(MPa). Its hidden layers have the activation
/// swish.
struct Network {
  NetworkShape shape;
  Eigen::VectorXd lower;  ///< lower bounds of the parameters, which are mapped to -1
  Eigen::VectorXd upper;  ///< upper bounds, which are mapped to +1
  std::vector<Layer> strain;
  std::vector<Layer> parameter;
  std::vector<Layer> trunk;
  std::vector<Layer> stiffness;  ///< empty for softplus
  TileGeometry geometry;         ///< the tile and `shape.features` features of it; unused if there are none
  /// Corrects the discretization error of the training data. This matrix times (1, p_i, p_i p_j for i <= j), with the
  /// mapped parameters p, is added to the 6 outputs of the stiffness branch. If the first three rows give the same
  /// number and the others give zero, the correction multiplies the energy by a factor, half of whose logarithm is that
  /// number. Derivatives remain exact, because the correction is a part of the network. If the matrix is empty, the
  /// network predicts what simulations on the mesh of its data give.
  Eigen::MatrixXd mesh_correction;
  /// Linear maps T of strains e that do not change the energies of the family. They belong to the rotations and mirrors
  /// of the structure onto itself, without the identity. The energy density is the mean of Phi(p, e) and all Phi(p, T
  /// e), so that it has these symmetries exactly. Each map takes one more evaluation. If the list is empty, the energy
  /// density is Phi(p, e).
  std::vector<Eigen::Matrix3d> symmetries;

  /// Number of weights and biases.
  long weights() const;
};

/// The parameters, mapped linearly from the network's bounds to [-1, 1].
Eigen::VectorXd mapped(const Network& network, std::span<const double> parameters);

/// The network without the correction of the data's discretization error. It is the one to be compared with data from
/// the mesh of the training data.
Network without_mesh_correction(Network network);

/// Throws "model.invalid_network", which names the layer, unless all sizes fit together and all numbers are finite.
void validate(const Network& network);

}  // namespace supple::neural
