#include <algorithm>
#include <cmath>

#include "file_makers.h"
#include "solid_files.h"
#include "solid_patch.h"

namespace supple::tiling {

std::string svg_of(const std::vector<Face>& faces, const std::string& title, const std::string& attributes) {
  Eigen::Vector2d half = Eigen::Vector2d::Zero();
  std::string path;
  for (const Face& face : faces) {
    for (const Polygon& polygon : face) {
      char command = 'M';
      for (const Eigen::Vector2d& p : polygon) {
        half = half.cwiseMax(p.cwiseAbs());
        // SVG's y points down.
        path += command + decimal(p.x()) + " " + decimal(-p.y());
        command = 'L';
      }
      path += "Z\n";
    }
  }
  const std::string width = decimal(2 * half.x()), height = decimal(2 * half.y());
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + width +
         "mm\" height=\"" + height + "mm\" viewBox=\"" + decimal(-half.x()) + " " + decimal(-half.y()) + " " + width +
         " " + height + "\"" + attributes + ">\n<title>" + title + "</title>\n<path fill-rule=\"evenodd\" d=\"" + path +
         "\"/>\n</svg>\n";
}

std::string make_svg(const Structure& structure, const ExportOptions& options) {
  const Eigen::Matrix2d& lattice = structure.tiling.lattice;
  std::string translations;
  for (int k = 0; k < 2; ++k) {
    if (k > 0) translations += ' ';
    translations += decimal(lattice(0, k)) + ' ' + decimal(-lattice(1, k));
  }
  return svg_of(solid_patch(structure, options), structure.family, " data-translations=\"" + translations + "\"");
}

}  // namespace supple::tiling
