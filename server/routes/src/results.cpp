#include "results.h"

#include <charconv>

namespace supple::routes {

void bill_requested(const Execution& execution, std::string_view effect, bool requested) {
  if (!execution.cost) return;
  execution.cost->add_effect(effect, requested,
                             requested ? "the request asks for it" : "the request does not ask for it");
}

void bill_error_bars(const neural::Model& model, const Execution& execution) {
  if (!execution.cost) return;
  const bool known = model.calibration.has_value();
  execution.cost->add_effect("error_bars", known,
                             known ? "the model knows by how much it errs" : "the model was not calibrated");
}

std::string plain_number(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

store::Result file_result(std::string_view media_type, std::string body, const json::Bill& bill) {
  return {std::string(media_type), {{"Supple-Seconds", plain_number(bill.seconds)}}, std::move(body)};
}

}  // namespace supple::routes
