#pragma once

namespace supple {

/// Whether an optional part of a computation runs; `automatic` decides from the problem and says how.
enum class Switch { automatic, on, off };

}  // namespace supple
