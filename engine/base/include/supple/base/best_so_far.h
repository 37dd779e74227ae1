#pragma once

#include <new>

#include "supple/base/cancellation.h"

namespace supple {

/// Runs a search whose best result so far is worth an answer. If the search is stopped because its deadline has passed
/// or a limit of memory is reached, and `has_result()` is true by then, the stop is taken back
/// (CancellationToken::resume), so that the best result can be reported, and its reason is returned: `deadline` or
/// `memory`. A block of memory that is refused counts as a limit of memory. Returns `none` if the search ended by
/// itself. Whatever else it throws passes, and so does a stop before there is a result.
template <class HasResult, class Search>
StopReason search_until_stopped(const CancellationToken& token, const HasResult& has_result, const Search& search) {
  const auto is_resumed = [&](StopReason reason) {
    return (reason == StopReason::deadline || reason == StopReason::memory) && has_result() && token.resume(reason);
  };
  try {
    search();
  } catch (const Cancelled& stop) {
    if (!is_resumed(stop.reason())) throw;
    return stop.reason();
  } catch (const std::bad_alloc&) {
    // A refused block may have requested a stop that nothing has thrown yet.
    const StopReason reason = token.reason();
    if (reason == StopReason::none ? !has_result() : !is_resumed(reason)) throw;
    return StopReason::memory;
  }
  return StopReason::none;
}

}  // namespace supple
