#pragma once

#include <cctype>
#include <new>
#include <string>
#include <string_view>

#include "supple/base/cancellation.h"

namespace supple {

/// Whether a search that is stopped for this reason answers with the best that it has found.
constexpr bool keeps_best(StopReason reason) { return reason == StopReason::deadline || reason == StopReason::memory; }

/// Why a search answers with the best that it has found, as a clause: the reason is `deadline` or `memory`.
constexpr std::string_view stop_clause(StopReason reason) {
  return reason == StopReason::deadline ? "the deadline passed" : "a limit of memory was reached";
}

/// A sentence that begins with this clause.
inline std::string stop_sentence(StopReason reason, std::string_view rest) {
  std::string sentence(stop_clause(reason));
  sentence.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence.front())));
  return sentence.append(rest);
}

/// Runs a search whose best result so far is worth an answer. If the search is stopped because its deadline has passed
/// or a limit of memory is reached, and `has_result()` is true by then, the stop is taken back
/// (CancellationToken::resume), so that the best result can be reported, and its reason is returned: `deadline` or
/// `memory`. A block of memory that is refused counts as a limit of memory. Returns `none` if the search ended by
/// itself. Whatever else it throws passes, and so does a stop before there is a result.
template <class HasResult, class Search>
StopReason search_until_stopped(const CancellationToken& token, const HasResult& has_result, const Search& search) {
  const auto is_resumed = [&](StopReason reason) { return keeps_best(reason) && has_result() && token.resume(reason); };
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

/// The same for a search whose token others share that run beside it: the stop is not taken back, so that they end,
/// too. Whoever waits for all of them takes it back.
template <class HasResult, class Search>
StopReason part_until_stopped(const CancellationToken& token, const HasResult& has_result, const Search& search) {
  try {
    search();
  } catch (const Cancelled& stop) {
    if (!keeps_best(stop.reason()) || !has_result()) throw;
    return stop.reason();
  } catch (const std::bad_alloc&) {
    const bool keeps = token.reason() == StopReason::none || keeps_best(token.reason());
    if (!keeps || !has_result()) throw;
    return StopReason::memory;
  }
  return StopReason::none;
}

}  // namespace supple
