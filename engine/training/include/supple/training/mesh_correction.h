#pragma once

#include <Eigen/Core>

#include "supple/dataset/dataset.h"
#include "supple/neural/model.h"
#include "supple/training/samples.h"

namespace supple::training {

/// Relative errors of Young's modulus at rest, over all designs and twelve directions.
struct ModulusErrors {
  double mean = 0;        ///< positive where moduli are too large
  double median = 0;      ///< of the absolute errors
  double quantile90 = 0;  ///< likewise
};

struct MeshCorrectionReport {
  int designs = 0;
  ModulusErrors mesh;       ///< what the mesh of the data errs by
  ModulusErrors corrected;  ///< what is left of it, for designs that had no part in the correction
};

/// Gives a model the correction of what the mesh of its data errs by (neural::Network::mesh_correction).
///
/// `data.rest` holds designs at rest on the mesh of the data (`supple-lab dataset rest`), and `reference` holds designs
/// with the same parameters at rest on a mesh that errs by much less. The differences of what stands for both
/// stiffnesses in the stiffness branch, the logarithms and quotients of a Cholesky factor, are fitted by polynomials of
/// degree 2 in the parameters, least squares. What is soft at rest is bending, where coarse meshes err most. Under load
/// the network adds nonlinear residuals to those of the linear strain, so that the correction fades where beams are
/// stretched, as the error of the mesh does (docs/notes/models.md has the figures).
///
/// The error bars of the model are removed, because they are those of the network without the correction. Throws
/// "dataset.different_recipe" if the data are of another family, solid or mesh than they should be, and
/// "training.no_samples" if fewer designs are in both than the polynomials have coefficients, times four.
neural::Model with_mesh_correction(neural::Model model, const ModelData& data, const dataset::Dataset& reference,
                                   MeshCorrectionReport& report);

}  // namespace supple::training
