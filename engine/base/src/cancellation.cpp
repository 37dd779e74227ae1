#include "supple/base/cancellation.h"

#include "supple/base/error.h"

namespace supple {

void CancellationToken::request(StopReason reason) const noexcept {
  int none = 0;
  reason_->compare_exchange_strong(none, static_cast<int>(reason));
}

void CancellationToken::throw_stop() const {
  switch (reason()) {
    case StopReason::deadline:
      throw Error("job.deadline_exceeded", "The computation was stopped because its deadline passed.");
    case StopReason::shutdown:
      throw Error("server.shutting_down", "The computation was stopped because the server is shutting down.");
    case StopReason::superseded:
      throw Error("design.superseded", "A newer request of the same session has replaced this one.");
    default:
      throw Error("job.cancelled", "The computation was cancelled.");
  }
}

}  // namespace supple
