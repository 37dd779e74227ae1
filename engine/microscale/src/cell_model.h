#pragma once

#include <memory>
#include <vector>

#include "cell_coordinates.h"
#include "contact_barrier.h"
#include "elastic_energy.h"
#include "rotation_retraction.h"
#include "supple/base/cost_ledger.h"
#include "supple/numerics/cholesky.h"
#include "supple/tiling/mesh.h"

namespace supple::microscale {

/// The terms of one periodic patch: what is simulated, without a state.
class CellModel {
 public:
  /// What is kept from one load path to the next: where the Hessian has entries, and how they are eliminated. For one
  /// objective at a time.
  struct Workspace {
    numerics::EnergySum sum;
    numerics::ShiftedCholesky cholesky;
  };

  CellModel(tiling::PeriodicMesh mesh, const Material& material, bool with_contact);

  const std::shared_ptr<const tiling::PeriodicMesh>& mesh() const { return mesh_; }
  const CellCoordinates& coordinates() const { return coordinates_; }
  const ElasticEnergy& elastic() const { return elastic_; }
  /// Null where contact is off.
  ContactBarrier* contact() { return contact_.get(); }
  const ContactBarrier* contact() const { return contact_.get(); }
  /// Gives the barrier its first stiffness and range again, so that a path does not depend on those before it.
  void reset_contact();

  /// Every term adds to the sum, which must be cleared. Bills elasticity as the stage "assembly", contact as an effect.
  void add(const Eigen::VectorXd& x, int order, numerics::EnergySum& sum, CostLedger* cost) const;
  void add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const;
  /// The largest share of a step for which every term stays valid. Contact looks ahead along it: states on it may be
  /// evaluated until the next call.
  double prepare(const Eigen::VectorXd& x, const Eigen::VectorXd& step, CostLedger* cost);
  /// The state after a step on which parts turn instead of growing (see RotationRetraction); not prepared.
  Eigen::VectorXd retract(const Eigen::VectorXd& x, const Eigen::VectorXd& step, CostLedger* cost) const;

  Workspace& workspace() { return workspace_; }

 private:
  std::shared_ptr<const tiling::PeriodicMesh> mesh_;
  CellCoordinates coordinates_;
  ElasticEnergy elastic_;
  RotationRetraction retraction_;
  ContactOptions contact_options_;
  std::unique_ptr<ContactBarrier> contact_;
  Workspace workspace_;
};

}  // namespace supple::microscale
