#pragma once

#include <array>
#include <cstdint>

namespace supple::cli {

/// The colour of a value in [0, 1]: from dark blue over green to yellow, rising evenly in lightness, so that it reads
/// in grey and for colour-blind eyes too. Values outside are clamped.
std::array<std::uint8_t, 3> color_of(double value);

}  // namespace supple::cli
