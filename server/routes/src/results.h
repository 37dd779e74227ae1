#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "supple/base/execution.h"
#include "supple/json/answers.h"
#include "supple/neural/model.h"
#include "supple/store/records.h"

// What the results of computations have in common.
namespace supple::routes {

/// Calls compute(execution) with a cost ledger and returns what it cost.
template <class Compute>
json::Bill billed(const Execution& outer, Compute compute) {
  json::Bill bill;
  Execution execution = outer;
  execution.cost = &bill.ledger;
  const auto start = std::chrono::steady_clock::now();
  compute(execution);
  bill.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return bill;
}

/// Bills an optional part that the request alone decides on.
void bill_requested(const Execution& execution, std::string_view effect, bool requested);

/// Bills whether the answers of a model have error bars.
void bill_error_bars(const neural::Model& model, const Execution& execution);

/// The shortest text that reads back as the same number, for headers.
std::string plain_number(double value);

inline store::Result json_result(std::string body) { return {"application/json", {}, std::move(body)}; }

/// A file, with the bill's seconds in the header Supple-Seconds.
store::Result file_result(std::string_view media_type, std::string body, const json::Bill& bill);

}  // namespace supple::routes
