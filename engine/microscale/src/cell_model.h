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

/// The terms of one periodic patch: what is simulated, without a state.
class CellModel {
 public:
  /// What is kept from one load path to the next: where the Hessian has entries, and how they are eliminated. For one
  /// system at a time.
  struct Workspace {
    std::shared_ptr<numerics::EnergySum> sums = std::make_shared<numerics::EnergySum>();
    numerics::ShiftedCholesky cholesky;
  };

  /// How states move. Long steps turn parts, which needs a factorization of its own; short ones may go straight.
  enum class Motion { turning, straight };

  CellModel(tiling::PeriodicMesh mesh, const Material& material, bool with_contact, Motion motion = Motion::turning);

  const std::shared_ptr<const tiling::PeriodicMesh>& mesh() const { return mesh_; }
  const CellCoordinates& coordinates() const { return coordinates_; }
  CellState state(Eigen::VectorXd x) const { return {std::move(x), retraction_ ? &*retraction_ : nullptr}; }
  /// Which of the displacements are held: node 0's, since a translation costs nothing.
  std::vector<bool> held() const;
  std::vector<std::shared_ptr<numerics::Term<CellState>>> terms() const;
  const ElasticEnergy& elastic() const { return *elastic_; }
  /// Null where contact is off.
  ContactBarrier* contact() { return contact_.get(); }
  const ContactBarrier* contact() const { return contact_.get(); }
  /// Gives the barrier its first stiffness and range again, so that a path does not depend on those before it.
  void reset_contact();

  /// Every term adds its own.
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
