#pragma once

#include "supple/base/cancellation.h"
#include "supple/base/cost_ledger.h"
#include "supple/base/progress.h"

namespace supple {

/// The surroundings of a computation: a token to stop it, a sink for its progress, and a ledger for its bill. All of
/// them are optional.
struct Execution {
  CancellationToken cancellation{};
  ProgressSink* progress = nullptr;
  CostLedger* cost = nullptr;

  void checkpoint(double fraction, std::string_view stage) const {
    cancellation.throw_if_requested();
    if (progress) progress->report(fraction, stage);
  }
};

}  // namespace supple
