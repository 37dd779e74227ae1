#pragma once

#include <string>
#include <utility>

#include "measurement.h"
#include "supple/base/cost_ledger.h"
#include "supple/base/execution.h"

namespace supple::bench {

/// A computation's result with what it took.
template <typename Result>
struct Billed {
  Result result;
  double cpu_seconds = 0;
  double wall_seconds = 0;
  CostLedger cost;
};

/// Runs `compute`, a function of an Execution, with a bill of its own.
template <typename Compute>
auto billed(Compute&& compute) {
  Billed<decltype(compute(std::declval<const Execution&>()))> outcome;
  Execution execution;
  execution.cost = &outcome.cost;
  const double start = wall_seconds();
  outcome.cpu_seconds = cpu_time([&] { outcome.result = compute(execution); });
  outcome.wall_seconds = wall_seconds() - start;
  return outcome;
}

/// Seconds billed to the stage of this name, 0 if there is none.
double stage_seconds(const CostLedger& cost, const std::string& name);
/// Seconds billed to the effect of this name, 0 if there is none.
double effect_seconds(const CostLedger& cost, const std::string& name);

}  // namespace supple::bench
