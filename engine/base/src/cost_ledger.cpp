#include "supple/base/cost_ledger.h"

namespace supple {
namespace {

template <typename Row>
Row& row_named(std::vector<Row>& rows, std::string_view name) {
  for (Row& row : rows) {
    if (row.name == name) return row;
  }
  rows.emplace_back();
  rows.back().name = name;
  return rows.back();
}

}  // namespace

void CostLedger::add_stage(std::string_view name, double seconds, std::int64_t count) {
  Stage& stage = row_named(stages_, name);
  stage.seconds += seconds;
  stage.count += count;
}

void CostLedger::add_effect(std::string_view name, bool ran, std::string_view why, std::int64_t count, double seconds) {
  Effect& effect = row_named(effects_, name);
  effect.ran = effect.ran || ran;
  effect.why = why;
  effect.count += count;
  effect.seconds += seconds;
}

void CostLedger::add_quantity(std::string_view name, double value) { row_named(quantities_, name).value += value; }

void CostLedger::merge(const CostLedger& other) {
  for (const Stage& s : other.stages_) add_stage(s.name, s.seconds, s.count);
  for (const Effect& e : other.effects_) add_effect(e.name, e.ran, e.why, e.count, e.seconds);
  for (const Quantity& q : other.quantities_) add_quantity(q.name, q.value);
}

double CostLedger::total_seconds() const {
  double total = 0;
  for (const Stage& s : stages_) total += s.seconds;
  return total;
}

}  // namespace supple
