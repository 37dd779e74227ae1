#include "cell_model.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace supple::microscale {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

CellModel::CellModel(tiling::PeriodicMesh mesh, const Material& material, bool with_contact)
    : mesh_(std::make_shared<const tiling::PeriodicMesh>(std::move(mesh))),
      coordinates_{mesh_->nodes.cols()},
      elastic_(*mesh_, material),
      retraction_(*mesh_),
      contact_options_(microscale::contact_options(*mesh_, material)) {
  workspace_.sum.hessian = numerics::HessianEntries(coordinates_.strain());
  if (with_contact) contact_ = std::make_unique<ContactBarrier>(*mesh_, contact_options_);
}

void CellModel::reset_contact() {
  if (!contact_) return;
  contact_->set_stiffness(contact_options_.stiffness);
  if (contact_->range() != contact_options_.range) contact_->set_range(contact_options_.range);
}

void CellModel::add(const Eigen::VectorXd& x, int order, numerics::EnergySum& sum, CostLedger* cost) const {
  const auto start = Clock::now();
  elastic_.add(x, order, sum);
  if (cost) cost->add_stage("assembly", seconds_since(start));
  if (!contact_ || !contact_->near()) return;
  const auto contact_start = Clock::now();
  contact_->add(x, order, sum);
  if (cost) cost->add_effect("contact", true, "pairs of boundary points came near", 1, seconds_since(contact_start));
}

void CellModel::add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const {
  elastic_.add_alternating_hessians(x, entries);
  if (contact_ && contact_->near()) contact_->add_alternating_hessians(x, entries);
}

double CellModel::prepare(const Eigen::VectorXd& x, const Eigen::VectorXd& step, CostLedger* cost) {
  double largest = elastic_.largest_step(x, step);
  if (!contact_) return largest;
  const auto start = Clock::now();
  // Only what the step can use: a step that inverts an element is cut before contacts are looked for.
  const double reach = std::min(1.0, largest);
  largest = std::min(largest, reach * contact_->prepare(x, reach * step));
  if (cost) cost->add_stage("contact search", seconds_since(start));
  return largest;
}

Eigen::VectorXd CellModel::retract(const Eigen::VectorXd& x, const Eigen::VectorXd& step, CostLedger* cost) const {
  const StageTimer timer(cost, "retraction");
  return retraction_.retract(x, step);
}

}  // namespace supple::microscale
