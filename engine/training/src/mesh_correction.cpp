#include "supple/training/mesh_correction.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "stiffness_outputs.h"
#include "supple/base/error.h"
#include "supple/neural/calibration.h"
#include "supple/training/model_errors.h"

namespace supple::training {
namespace {

constexpr int direction_count = 12;
constexpr int fold_count = 10;
constexpr int designs_per_coefficient = 4;

StiffnessOutputs stiffness_to_outputs(const Eigen::Matrix3d& stiffness) {
  return outputs_of(Eigen::LLT<Eigen::Matrix3d>(stiffness).matrixL());
}

/// The stiffness of an undeformed design on both meshes, as outputs of the stiffness branch.
struct DesignPair {
  Eigen::VectorXd terms;  ///< neural::quadratic_terms of its mapped parameters
  StiffnessOutputs mesh;
  StiffnessOutputs reference;
};

std::vector<DesignPair> pairs_of(const neural::Network& network, const std::vector<RestStiffness>& mesh,
                                 const std::vector<RestStiffness>& reference) {
  std::map<std::vector<double>, const Eigen::Matrix3d*> by_parameters;
  for (const auto& design : reference) by_parameters[design.parameters] = &design.tangent;
  std::vector<DesignPair> pairs;
  for (const auto& design : mesh) {
    const auto found = by_parameters.find(design.parameters);
    if (found == by_parameters.end()) continue;
    pairs.push_back({neural::quadratic_terms(neural::mapped(network, design.parameters)),
                     stiffness_to_outputs(design.tangent), stiffness_to_outputs(*found->second)});
  }
  return pairs;
}

/// The coefficients of the correction, 6 x terms, fitted to all pairs but those of the excluded fold (negative: to
/// all).
Eigen::MatrixXd fitted(const std::vector<DesignPair>& pairs, int excluded_fold) {
  std::vector<const DesignPair*> fitted_pairs;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (static_cast<int>(i % fold_count) != excluded_fold) fitted_pairs.push_back(&pairs[i]);
  const auto n = static_cast<long>(fitted_pairs.size());
  Eigen::MatrixXd terms(n, pairs.front().terms.size());
  Eigen::MatrixXd differences(n, 6);
  for (long i = 0; i < n; ++i) {
    const DesignPair& pair = *fitted_pairs[static_cast<std::size_t>(i)];
    terms.row(i) = pair.terms.transpose();
    differences.row(i) = (pair.reference - pair.mesh).transpose();
  }
  return terms.colPivHouseholderQr().solve(differences).transpose();
}

/// Young's modulus along a direction (radians) in the material.
double modulus(const Eigen::Matrix3d& compliance, double direction) {
  const double c = std::cos(direction);
  const double s = std::sin(direction);
  const Eigen::Vector3d dyad(c * c, s * s, c * s);
  return 1 / dyad.dot(compliance * dyad);
}

void add_errors(const StiffnessOutputs& outputs, const StiffnessOutputs& reference, std::vector<double>& errors) {
  const auto compliance_of = [](const StiffnessOutputs& of) -> Eigen::Matrix3d {
    const Eigen::Matrix3d l = factor_of(of);
    return (l * l.transpose()).inverse();
  };
  const Eigen::Matrix3d compliance = compliance_of(outputs);
  const Eigen::Matrix3d exact = compliance_of(reference);
  for (int k = 0; k < direction_count; ++k) {
    const double direction = k * std::numbers::pi / direction_count;
    errors.push_back(modulus(compliance, direction) / modulus(exact, direction) - 1);
  }
}

ModulusErrors summary(const std::vector<double>& errors) {
  const Eigen::Map<const Eigen::VectorXd> all(errors.data(), static_cast<long>(errors.size()));
  const Eigen::VectorXd magnitudes = all.cwiseAbs();
  return {all.mean(), quantile(magnitudes, 0.5), quantile(magnitudes, 0.9)};
}

}  // namespace

neural::Model with_mesh_correction(neural::Model model, const ModelData& data, const dataset::Dataset& reference,
                                   MeshCorrectionReport& report) {
  check_same_solid(data, reference);
  const auto pairs = pairs_of(model.network, read_rest(data), rest_stiffnesses(reference));
  const auto terms = 1 + model.network.lower.size() * (model.network.lower.size() + 3) / 2;
  const auto min_designs = designs_per_coefficient * terms;
  if (static_cast<long>(pairs.size()) < min_designs)
    throw Error("training.no_samples",
                fmt::format("A correction of the mesh needs {} designs at rest on both meshes; there are {}.",
                            min_designs, pairs.size()));
  std::vector<double> before;
  std::vector<double> after;
  for (int fold = 0; fold < fold_count; ++fold) {
    const Eigen::MatrixXd correction = fitted(pairs, fold);
    for (std::size_t i = static_cast<std::size_t>(fold); i < pairs.size(); i += fold_count) {
      const DesignPair& pair = pairs[i];
      add_errors(pair.mesh, pair.reference, before);
      add_errors(pair.mesh + correction * pair.terms, pair.reference, after);
    }
  }
  report = {static_cast<int>(pairs.size()), summary(before), summary(after)};
  model.network.mesh_correction = fitted(pairs, -1);
  neural::validate(model.network);
  model.calibration.reset();
  return model;
}

}  // namespace supple::training
