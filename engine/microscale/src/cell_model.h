#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "cell_coordinates.h"
#include "contact_barrier.h"
#include "elastic_energy.h"
#include "rotation_retraction.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/unknowns.h"
#include "supple/tiling/mesh.h"

namespace supple::microscale {

/// The mesh and the energy terms of one periodic patch, without a state.
class CellModel {
 public:
  /// Memory that load paths use one after another: the sparsity pattern of the Hessian and its symbolic factorization.
  /// Only one system may use it at a time.
  struct Workspace {
    std::shared_ptr<numerics::EnergySum> sums = std::make_shared<numerics::EnergySum>();
    numerics::ShiftedCholesky cholesky;
  };

  /// The curve on which a state makes a step. Long steps need `rotational`, for which a Laplacian is factorized (see
  /// RotationRetraction). For short ones, `linear` suffices: a straight line.
  enum class Retraction { rotational, linear };

  CellModel(tiling::PeriodicMesh mesh, const Material& material, bool with_contact,
            Retraction retraction = Retraction::rotational);

  const std::shared_ptr<const tiling::PeriodicMesh>& mesh() const { return mesh_; }
  const CellCoordinates& coordinates() const { return coordinates_; }
  CellState state(Eigen::VectorXd x) const { return {std::move(x), retraction_ ? &*retraction_ : nullptr}; }
  /// For each displacement whether it is fixed. Node 0 is fixed, because a translation of the patch costs no energy.
  std::vector<bool> fixed_displacements() const;
  std::vector<std::shared_ptr<numerics::Term<CellState>>> terms() const;
  const ElasticEnergy& elastic() const { return *elastic_; }
  /// Null if contact is off.
  ContactBarrier* contact() { return contact_.get(); }
  const ContactBarrier* contact() const { return contact_.get(); }
  /// Resets the barrier's stiffness and range, so that a path does not depend on earlier paths.
  void reset_contact();

  /// Adds the Hessians of all terms; see CellTerm::add_alternating_hessians.
  void add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const;

  Workspace& workspace() { return workspace_; }

 private:
  std::shared_ptr<const tiling::PeriodicMesh> mesh_;
  CellCoordinates coordinates_;
  std::shared_ptr<ElasticEnergy> elastic_;
  std::optional<RotationRetraction> retraction_;
  ContactOptions contact_options_;
  std::shared_ptr<ContactBarrier> contact_;
  Workspace workspace_;
};

}  // namespace supple::microscale
