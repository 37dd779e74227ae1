#pragma once

namespace supple {

/// Whether an optional part of a computation runs. `automatic` decides it from the problem and reports the reason.
enum class Switch { automatic, on, off };

}  // namespace supple
