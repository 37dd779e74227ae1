#pragma once

#include <Eigen/Core>

#include "supple/dataset/dataset.h"
#include "supple/neural/model.h"
#include "supple/training/samples.h"

namespace supple::training {

/// Relative errors of Young's modulus of the undeformed structure, over all designs and twelve directions.
struct ModulusErrors {
  double mean = 0;           ///< mean signed error; positive where moduli are too large
  double median = 0;         ///< median of the absolute errors
  double percentile_90 = 0;  ///< 90th percentile of the absolute errors
};

struct MeshCorrectionReport {
  int designs = 0;
  ModulusErrors uncorrected;  ///< discretization errors of the data's mesh
  ModulusErrors corrected;    ///< errors that remain, cross-validated: for designs that were not used in the fit
};

/// Gives a model a correction of the discretization error of its data's mesh (neural::Network::mesh_correction).
///
/// `data.rest` holds undeformed designs on the mesh of the data (`supple-lab dataset rest`), and `reference` holds
/// designs with the same parameters on a much more accurate mesh. The stiffness branch represents a stiffness by
/// logarithms and quotients of the entries of its Cholesky factor (see neural::Network). The differences of these six
/// numbers between both meshes are fitted by polynomials of degree 2 in the parameters, by least squares. Undeformed
/// structures are soft because their beams bend, and bending is where coarse meshes err most. Under load the network
/// adds nonlinear residuals to those of the linear strain. Therefore the correction fades where beams are stretched, as
/// the error of the mesh does (docs/notes/models.md has the figures).
///
/// The error bars of the model are removed, because they belong to the network without the correction. Throws
/// "dataset.different_recipe" if `data.rest` is of another family, solid or mesh than `data`, or `reference` of another
/// family or solid. Throws "training.no_samples" if fewer designs are in both sets than four times the number of
/// coefficients of a polynomial.
neural::Model with_mesh_correction(neural::Model model, const ModelData& data, const dataset::Dataset& reference,
                                   MeshCorrectionReport& report);

}  // namespace supple::training
