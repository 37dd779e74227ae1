#include "svg_page.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "svg_attributes.h"

namespace supple::outlines {
namespace {

constexpr double pixels_per_inch = 96;
/// Bytes at the beginning of a file in which the program that wrote it is named.
constexpr std::size_t searched_head_bytes = 4'096;
/// The first version of Inkscape with 96 pixels per inch.
constexpr double first_inkscape_with_96 = 0.92;

/// Whether the side of a page is given in a unit of length rather than in pixels.
bool has_unit(const pugi::xml_node& root, const char* name) {
  std::string_view text = root.attribute(name).value();
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  if (text.size() < 2 || text.ends_with("px")) return text.ends_with("Q");
  for (const std::string_view unit : {"mm", "cm", "in", "pt", "pc", "Q"}) {
    if (text.ends_with(unit)) return true;
  }
  return false;
}

/// Throws "outline.resolution_missing" if the file is of a program whose pixels were not 1/96 inch.
void ask_for_resolution(const SvgDocument& document) {
  const std::string_view head = document.text().substr(0, std::min(document.text().size(), searched_head_bytes));
  const auto ask = [](const std::string& program, const std::string& pixels) {
    const std::string words = "the file is of " + program + ", and its sizes are pixels: give " + pixels +
                              " pixels per inch, or the drawing's unit or width";
    throw Error("outline.resolution_missing", "The size of the drawing is not known: " + words + ".",
                {{"resolution", words}});
  };
  if (head.find("Adobe Illustrator") != std::string_view::npos) ask("Adobe Illustrator", "72 (its own) or 96");
  std::string_view version;
  for (const auto& attribute : document.root().attributes()) {
    const std::string_view name(attribute.name());
    if (name == "inkscape:version") version = attribute.value();
  }
  const auto old = take_number(version);
  if (old && *old < first_inkscape_with_96) ask("Inkscape before 0.92", "90 (that of such a version) or 96");
}

}  // namespace

SvgPage page_of(const SvgDocument& document, const DrawingOptions& options) {
  const pugi::xml_node root = document.root();
  const auto side = [&root](const char* name) -> std::optional<double> {
    const auto attribute = root.attribute(name);
    if (!attribute || std::string_view(attribute.value()) == "auto") return std::nullopt;
    const auto value = read_length(attribute.value());
    if (value && !(*value > 0)) throw std::invalid_argument(std::string(name) + " must be positive");
    return value;
  };
  const auto width = side("width"), height = side("height");
  const auto box = box_of(root);
  // The map of the view box and the size of the page, in user units of the page.
  Map view = Map::Identity();
  Eigen::Vector2d size(width.value_or(0), height.value_or(0));
  SvgPage page;
  const bool is_physical = has_unit(root, "width") || has_unit(root, "height");
  double unit = is_physical ? mm_per_pixel : mm_per_inch / options.resolution.value_or(pixels_per_inch);
  page.unit_is_known = is_physical || options.resolution;
  if (!page.unit_is_known && !options.width && options.unit == LengthUnit::automatic) ask_for_resolution(document);
  if (const auto wanted = millimetres_of(options.unit)) {
    unit = *wanted;
    page.unit_is_known = true;
    if (!box.empty()) {
      size = {box[2], box[3]};
      view.translation() << -box[0], -box[1];
    }
  } else if (!box.empty()) {
    const double scale = width ? *width / box[2] : height ? *height / box[3] : 1;
    size = {scale * box[2], height.value_or(scale * box[3])};
    view = view_of(root, box, size);
  }
  page.has_page = !box.empty() || height;
  page.unit = unit * view.linear()(0, 0);
  Map upwards = Map::Identity();
  upwards.linear() << unit, 0, 0, -unit;
  upwards.translation() << 0, unit * size.y();
  page.size = box.empty() ? size : Eigen::Vector2d(box[2], box[3]);
  page.size_mm = unit * size;
  page.map = upwards * view;
  return page;
}

}  // namespace supple::outlines
