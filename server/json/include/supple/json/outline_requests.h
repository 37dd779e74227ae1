#pragma once

#include <string>
#include <string_view>

#include "supple/json/answers.h"
#include "supple/json/limits.h"
#include "supple/outlines/drawing.h"

/// Drawings that become outlines, as request and answer; the request is read like those of requests.h. Whether the text
/// is a drawing is not checked here.
namespace supple::json {

struct OutlineRequest {
  std::string text;
  outlines::DrawingOptions options;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
OutlineRequest parse_outlines(std::string_view body, const Limits& limits);

std::string write_outlines(const OutlineRequest& request, const outlines::Drawing& drawing, const Bill& bill);

}  // namespace supple::json
