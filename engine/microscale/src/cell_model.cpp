#include "cell_model.h"

#include <utility>

namespace supple::microscale {

CellModel::CellModel(tiling::PeriodicMesh mesh, const Material& material, bool with_contact, Retraction retraction)
    : mesh_(std::make_shared<const tiling::PeriodicMesh>(std::move(mesh))),
      coordinates_{mesh_->nodes.cols()},
      elastic_(std::make_shared<ElasticEnergy>(*mesh_, material)),
      contact_options_(microscale::contact_options(*mesh_, material)) {
  if (retraction == Retraction::rotational) retraction_.emplace(*mesh_);
  workspace_.sums->hessian = numerics::HessianEntries(numerics::Unknowns(fixed_displacements()).numbering());
  if (with_contact) contact_ = std::make_shared<ContactBarrier>(*mesh_, contact_options_);
}

void CellModel::reset_contact() {
  if (!contact_) return;
  contact_->set_stiffness(contact_options_.stiffness);
  if (contact_->range() != contact_options_.range) contact_->set_range(contact_options_.range);
}

std::vector<bool> CellModel::fixed_displacements() const {
  std::vector<bool> fixed(static_cast<std::size_t>(coordinates_.strain()), false);
  fixed[0] = fixed[1] = true;
  return fixed;
}

std::vector<std::shared_ptr<numerics::Term<CellState>>> CellModel::terms() const {
  // Elasticity comes first, so that a step that would invert an element is shortened before contacts are searched.
  if (!contact_) return {elastic_};
  return {elastic_, contact_};
}

void CellModel::add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const {
  elastic_->add_alternating_hessians(x, entries);
  if (contact_ && contact_->active()) contact_->add_alternating_hessians(x, entries);
}

}  // namespace supple::microscale
