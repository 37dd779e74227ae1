#pragma once

#include <Eigen/Core>
#include <memory>
#include <string_view>

#include "chart.h"

namespace supple::weave {

/// All degrees of freedom q of a weave (see RodModel) and, in space, the chart to which its angles and rotations refer.
/// Derivatives are taken in the chart at the state itself, so that no Newton step starts at a singularity.
class RodState {
 public:
  /// `model` must outlive the state. `chart` is the one to which q refers; it is empty in the plane.
  RodState(const RodModel& model, Eigen::VectorXd q, Chart chart = {});

  const Eigen::VectorXd& q() const { return q_; }
  const Chart& chart() const { return *chart_; }

  static constexpr std::string_view motion{};
  Eigen::Index dimension() const { return q_.size(); }
  Eigen::VectorXd move(const Eigen::VectorXd& step) {
    q_ += step;
    return step;
  }
  /// Replaces the chart by the one at the current state. The joints' unknowns become 0.
  void take_frame();
  /// Charts of neighbouring states differ little, so the coordinates of a tangent vector stay as they are.
  bool transport(Eigen::VectorXd& /*tangent*/) const { return true; }

 private:
  const RodModel* model_;
  Eigen::VectorXd q_;
  std::shared_ptr<const Chart> chart_;
};

}  // namespace supple::weave
