#pragma once

#include <cstdint>

namespace supple {

/// Descriptors of a helper: its channel, a socket, and its lifeline, a pipe whose other end is open while the process
/// that started the helper lives.
inline constexpr int helper_channel = 3;
inline constexpr int helper_lifeline = 4;

/// How a task ended. A message consists of its length, 64 bits, and its bytes. The first byte of an answer is the
/// outcome.
enum class HelperOutcome : std::uint8_t { done = 0, error = 1, out_of_memory = 2, exception = 3 };

}  // namespace supple
