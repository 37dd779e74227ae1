#pragma once

#include "supple/base/cancellation.h"
#include "supple/base/cost_ledger.h"
#include "supple/base/progress.h"

namespace supple {

/// What surrounds a computation: who may stop it, who hears how far it is, who writes the bill. All optional.
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
