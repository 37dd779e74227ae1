#pragma once

#include <cstdint>

namespace supple {

/// Where a helper finds its channel, a socket, and the pipe whose other end is open while the process that started it
/// lives.
inline constexpr int helper_channel = 3;
inline constexpr int helper_lifeline = 4;

/// How a task ended. Each message is its length, 64 bits, and so many bytes, of an answer this kind first.
enum class HelperOutcome : std::uint8_t { done = 0, error = 1, out_of_memory = 2, exception = 3 };

}  // namespace supple
