#pragma once

#include <string>
#include <string_view>

#include "supple/base/cancellation.h"
#include "supple/json/answers.h"
#include "supple/json/limits.h"
#include "supple/json/name_table.h"
#include "supple/outlines/drawing.h"

/// Drawings that become outlines, as request and answer; the request is read like those of requests.h. Whether the text
/// is a drawing is not checked here.
namespace supple::json {

inline constexpr auto drawing_format_names =
    names_of<outlines::DrawingFormat>({{outlines::DrawingFormat::automatic, "automatic"},
                                       {outlines::DrawingFormat::svg, "svg"},
                                       {outlines::DrawingFormat::dxf, "dxf"}});
inline constexpr auto length_unit_names =
    names_of<outlines::LengthUnit>({{outlines::LengthUnit::automatic, "automatic"},
                                    {outlines::LengthUnit::mm, "mm"},
                                    {outlines::LengthUnit::cm, "cm"},
                                    {outlines::LengthUnit::m, "m"},
                                    {outlines::LengthUnit::in, "in"},
                                    {outlines::LengthUnit::ft, "ft"},
                                    {outlines::LengthUnit::pt, "pt"},
                                    {outlines::LengthUnit::px, "px"}});

struct OutlineRequest {
  std::string text;
  outlines::DrawingOptions options;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
OutlineRequest parse_outlines(std::string_view body, const Limits& limits, const CancellationToken& cancellation = {});

std::string write_outlines(const OutlineRequest& request, const outlines::Drawing& drawing, const Bill& bill);

}  // namespace supple::json
