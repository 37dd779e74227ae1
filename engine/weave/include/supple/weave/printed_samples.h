#pragma once

#include <array>
#include <string_view>

#include "supple/weave/toolpath.h"

namespace supple::weave {

/// Sheets that have been printed and tested, each with its layout, profile and options. Lengths are in mm.
enum class Sample {
  fused_grid,    ///< 20 x 20 strands at a pitch of 4, 80 x 80, with a frame and overruns of 24
  sliding_grid,  ///< as fused_grid, but the strands along y slide
  squares_1,     ///< 5 x 5 and 4 x 4 interlacing squares of side 12 between two grips; SquareType 1 to 4
  squares_2,
  squares_3,
  squares_4,
  circles_fused,  ///< 6 x 5 circles of radius 8, with half circles at the grips
  circles_sliding,
  actuation,  ///< three rings, spokes and a strand that is pushed
};
inline constexpr std::array all_samples{Sample::fused_grid,    Sample::sliding_grid,    Sample::squares_1,
                                        Sample::squares_2,     Sample::squares_3,       Sample::squares_4,
                                        Sample::circles_fused, Sample::circles_sliding, Sample::actuation};
/// The name of a sample, as it is written above.
std::string_view to_string(Sample sample);

struct PrintJob {
  Weave weave{};
  PrinterProfile profile{};
  ToolpathOptions options{};
};
PrintJob printed_sample(Sample sample);

}  // namespace supple::weave
