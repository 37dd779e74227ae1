#include "bill.h"

#include <vector>

namespace supple::bench {
namespace {

template <typename Entry>
double seconds_of(const std::vector<Entry>& entries, const std::string& name) {
  for (const Entry& entry : entries)
    if (entry.name == name) return entry.seconds;
  return 0;
}

}  // namespace

double stage_seconds(const CostLedger& cost, const std::string& name) { return seconds_of(cost.stages(), name); }
double effect_seconds(const CostLedger& cost, const std::string& name) { return seconds_of(cost.effects(), name); }

}  // namespace supple::bench
