#pragma once

#include <array>
#include <cstdint>

namespace supple::cli {

/// The colour of a value in [0, 1], from dark blue over green to yellow. Lightness increases evenly, so that the map
/// is also legible in greyscale and to colour-blind people. Values outside are clamped.
std::array<std::uint8_t, 3> color_of(double value);

}  // namespace supple::cli
