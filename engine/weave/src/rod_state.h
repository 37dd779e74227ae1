#pragma once

#include <Eigen/Core>
#include <memory>
#include <string_view>

#include "chart.h"

namespace supple::weave {

/// All degrees of freedom q of a weave (see RodModel) and, in space, the chart that they are seen from. Derivatives are
/// given in the chart at the state itself, so that every Newton step starts from one without singularities.
class RodState {
 public:
  /// `model` outlives the state. The chart is empty in the plane; q is seen from it.
  RodState(const RodModel& model, Eigen::VectorXd q, Chart chart = {});

  const Eigen::VectorXd& q() const { return q_; }
  const Chart& chart() const { return *chart_; }

  static constexpr std::string_view motion{};
  Eigen::Index dimension() const { return q_.size(); }
  Eigen::VectorXd move(const Eigen::VectorXd& step) {
    q_ += step;
    return step;
  }
  /// Rebases the chart: the joints' unknowns become 0.
  void take_frame();
  /// Charts of neighbouring states differ little: coordinates are carried along as they are.
  bool transport(Eigen::VectorXd& /*tangent*/) const { return true; }

 private:
  const RodModel* model_;
  Eigen::VectorXd q_;
  std::shared_ptr<const Chart> chart_;
};

}  // namespace supple::weave
