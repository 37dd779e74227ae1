// Feeds arbitrary bytes to the drawing readers, which must return polygons within the limits or throw an Error.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "supple/base/error.h"
#include "supple/outlines/drawing.h"

namespace {

using namespace supple::outlines;

void require(bool condition) {
  if (!condition) std::abort();
}

void check_drawing(const Drawing& drawing, const DrawingOptions& options) {
  require(!drawing.outlines.empty() && drawing.curves <= 20'000);
  std::size_t corners = 0;
  for (const Outline& outline : drawing.outlines) {
    require(outline.corners.size() >= 3 && outline.names.size() <= 10);
    for (const auto& name : outline.names) require(name.size() <= 100);
    for (const auto& corner : outline.corners) require(corner.allFinite());
    corners += outline.corners.size();
  }
  require(corners <= 100'000);
  require(drawing.lower.allFinite() && drawing.upper.allFinite());
  require(drawing.chord_error >= 0 && drawing.chord_error < 1e7 && drawing.unit > 0);
  require(drawing.left_out.size() <= drawing.left_out_count && drawing.left_out.size() <= Drawing::max_left_out);
  for (const OmittedElement& one : drawing.left_out) require(!one.element.empty() && !one.reason.empty());
  if (options.width) require(drawing.upper.x() - drawing.lower.x() < 1.01 * *options.width);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const DrawingFormat format : {DrawingFormat::svg, DrawingFormat::dxf}) {
    for (const bool scaled : {false, true}) {
      DrawingOptions options;
      options.format = format;
      if (scaled) options.width = 50;
      try {
        check_drawing(read_drawing(bytes, options), options);
      } catch (const supple::Error& error) {
        require(error.code().starts_with("outline.") && !error.details().empty());
      }
    }
  }
  return 0;
}
