#include "rod_state.h"

#include <utility>

namespace supple::weave {

RodState::RodState(const RodModel& model, Eigen::VectorXd q, Chart chart)
    : model_(&model), q_(std::move(q)), chart_(std::make_shared<const Chart>(std::move(chart))) {}

void RodState::take_frame() {
  if (model_->spatial()) chart_ = std::make_shared<const Chart>(rebase(*model_, *chart_, q_));
}

}  // namespace supple::weave
