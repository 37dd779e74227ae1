/// Fills the first outline of a drawing with a tiling, prints what the part is like, and writes it as an SVG file.
///
///     fill_drawing DRAWING FAMILY FILE.svg        an SVG or DXF drawing, and for example IH21
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

#include "supple/outlines/drawing.h"
#include "supple/tiling/part.h"

namespace {

void write_part(const char* path, const char* family, const char* svg) {
  using namespace supple;
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const outlines::Drawing drawing = outlines::read_drawing(text);

  tiling::PartDesign design;
  design.outline = {drawing.outlines.front().corners};
  design.filling.structure = tiling::make_structure(family);
  design.filling.beam_width = 0.6;  // mm
  design.frame = 1.5;
  const tiling::Part part = tiling::make_part(design);
  std::cout << drawing.outlines.size() << " outlines; the first one is " << tiling::size_words(part)
            << "\nthe material covers " << part.solid_area << " of " << part.outline_area << " mm^2\n";
  std::ofstream(svg) << tiling::part_svg(part);
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 4) {
    std::cerr << "usage: fill_drawing DRAWING FAMILY FILE.svg\n";
    return 2;
  }
  write_part(arguments[1], arguments[2], arguments[3]);
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
