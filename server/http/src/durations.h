#pragma once

#include <chrono>

namespace supple::http {

/// The duration of this many seconds.
inline std::chrono::steady_clock::duration duration_of(double seconds) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace supple::http
