#include "supple/base/cancellation.h"

namespace supple {
namespace {

/// Whether a stop for this reason is never taken back.
bool is_final(StopReason reason) { return reason != StopReason::deadline && reason != StopReason::memory; }

}  // namespace

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
  const auto wanted = static_cast<unsigned>(reason);
  unsigned reasons = reasons_->load(std::memory_order_relaxed);
  while (true) {
    unsigned changed = wanted;
    if (reasons != 0) {
      const bool is_noted = is_final(reason) && !is_final(static_cast<StopReason>(reasons % later_reason));
      if (!is_noted || reasons >= later_reason) return;
      changed = reasons + later_reason * wanted;
    }
    if (reasons_->compare_exchange_weak(reasons, changed)) return;
  }
}

bool CancellationToken::resume(StopReason reason) const noexcept {
  unsigned reasons = reasons_->load(std::memory_order_relaxed);
  do {
    if (reason == StopReason::none || static_cast<StopReason>(reasons % later_reason) != reason) return false;
  } while (!reasons_->compare_exchange_weak(reasons, reasons / later_reason));
  return true;
}

}  // namespace supple
