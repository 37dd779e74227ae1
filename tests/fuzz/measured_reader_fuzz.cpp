// Feeds arbitrary bytes to the reader of measurements, which must return finite points or throw an Error that names a
// field.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "supple/base/error.h"
#include "supple/design/measured_text.h"
#include "supple/design/measurements.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t longest = 1 << 16;
  if (size > longest) return 0;
  supple::design::MeasurementRequest request;
  request.text = supple::design::decode_text({reinterpret_cast<const char*>(data), size}).text;
  if (!supple::design::is_utf8(*request.text)) std::abort();
  request.specimen = {50, 20};
  try {
    const auto found = supple::design::read_measurements(request);
    if (found.curve.points.size() != found.table->rows()) std::abort();
    for (const auto& column : found.table->columns) {
      if (column.values.size() != found.table->rows()) std::abort();
      if (!supple::design::is_utf8(column.title) || !supple::design::is_utf8(column.unit)) std::abort();
    }
  } catch (const supple::Error& error) {
    if (error.details().empty()) std::abort();
  }
  return 0;
}
