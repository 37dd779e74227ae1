#include "supple/base/cancellation.h"

namespace supple {

const char* Cancelled::what() const noexcept {
  switch (reason_) {
    case StopReason::deadline:
      return "The computation was stopped because its deadline passed.";
    case StopReason::shutdown:
      return "The computation was stopped because the server is shutting down.";
    case StopReason::superseded:
      return "A newer request of the same session has replaced this one.";
    case StopReason::memory:
      return "The computation was stopped because it reached a limit of memory.";
    default:
      return "The computation was cancelled.";
  }
}

void CancellationToken::request(StopReason reason) const noexcept {
  int none = 0;
  reason_->compare_exchange_strong(none, static_cast<int>(reason));
}

bool CancellationToken::resume(StopReason reason) const noexcept {
  int requested = static_cast<int>(reason);
  return reason != StopReason::none && reason_->compare_exchange_strong(requested, static_cast<int>(StopReason::none));
}

}  // namespace supple
