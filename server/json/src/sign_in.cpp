#include "document.h"
#include "fields.h"
#include "supple/json/requests.h"

namespace supple::json {

std::string parse_sign_in(std::string_view body, const Limits& limits) {
  const auto document = parse_document(body, limits);
  Faults faults({});
  Fields fields(document, "", faults);
  std::string key;
  if (const auto* value = fields.required("key")) {
    // The message does not repeat the value, which may be a key with a typing error.
    if (value->is_string()) key = value->get<std::string>();
    if (!value->is_string()) faults.add(fields.at("key"), "must be a string");
  }
  fields.finish();
  faults.throw_if_any();
  return key;
}

}  // namespace supple::json
