#include "supple/microscale/part_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "supple/base/file_text.h"
#include "supple/base/number_text.h"
#include "supple/microscale/part_strain.h"

namespace supple::microscale {
namespace {

/// The fraction of the triangles whose strains the colours distinguish.
constexpr double colored_fraction = 0.99;
/// The least strain that gets the last colour, so that the scale of a part at rest is not empty.
constexpr double min_full_strain = 1e-6;

// Lengths of a picture, divided by the larger side of what it shows.
constexpr double picture_margin = 0.03;
constexpr double scale_height = 0.03;
constexpr double text_height = 0.03;
constexpr double text_distance = 0.04;
/// Widths of the fields of the scale, divided by their distance, so that no gap is seen between them.
constexpr double scale_overlap = 1.02;
/// Widths of the lines that close the gaps between triangles of one colour, divided by the size of the mesh.
constexpr double seam_width = 0.02;
/// Steps by which coordinates of a picture are rounded, for each of its larger side.
constexpr double min_steps = 1e4;

/// Red, green and blue of colours between which those of strains are interpolated. Their lightness increases in almost
/// equal steps.
constexpr std::array<std::array<double, 3>, 6> key_colors = {
    {{32, 18, 77}, {44, 62, 136}, {32, 110, 142}, {38, 156, 128}, {120, 200, 82}, {245, 228, 60}}};
/// Number of colours in a picture, each of which is one path.
constexpr std::size_t color_count = 24;

/// The nodes of a quadratic triangle in their order around it.
constexpr std::array<std::size_t, 6> outline_order{0, 3, 1, 4, 2, 5};

std::string color_text(std::size_t color) {
  const double position = static_cast<double>(color) * (key_colors.size() - 1) / (color_count - 1);
  const auto low = std::min(static_cast<std::size_t>(position), key_colors.size() - 2);
  const double fraction = position - static_cast<double>(low);
  FileText text;
  text << "rgb(";
  for (std::size_t i = 0; i < 3; ++i) {
    const double value = (1 - fraction) * key_colors[low][i] + fraction * key_colors[low + 1][i];
    text.number(std::lround(value), i < 2 ? ',' : ')');
  }
  return text.take();
}

std::size_t color_of(double strain, const PictureFrame& frame) {
  const double position = std::clamp(strain / frame.full_strain, 0.0, 1.0) * color_count;
  return std::min(static_cast<std::size_t>(position), color_count - 1);
}

/// The strain that the coloured fraction of the triangles does not exceed.
double usual_strain(std::vector<double> strains) {
  if (strains.empty()) return 0;
  const auto place = static_cast<std::ptrdiff_t>(colored_fraction * static_cast<double>(strains.size() - 1));
  std::nth_element(strains.begin(), strains.begin() + place, strains.end());
  return strains[static_cast<std::size_t>(place)];
}

/// Places of a picture: y points down, and coordinates are rounded to what can be seen.
class PicturePlaces {
 public:
  explicit PicturePlaces(const PictureFrame& frame) : frame_(frame) {
    side_ = std::max((frame.upper - frame.lower).maxCoeff(), 1e-9);
    steps_ = std::pow(10, std::ceil(std::log10(min_steps / side_)));
  }
  double side() const { return side_; }
  double rounded(double length) const { return std::round(length * steps_) / steps_; }
  void add(FileText& text, char command, const Eigen::Vector2d& p) const {
    text << std::string_view(&command, 1);
    text.number(rounded(p.x() - frame_.lower.x())).number(rounded(frame_.upper.y() - p.y()), '\n');
  }

 private:
  const PictureFrame& frame_;
  double side_;
  double steps_;  ///< for each mm
};

/// An attribute of an element: " width=\"12\"".
std::string attribute(std::string_view name, double value) {
  return " " + std::string(name) + "=\"" + number_text(value) + "\"";
}

/// The scale of colours below the part, and what it means.
std::string color_scale(const PicturePlaces& places, const PictureFrame& frame) {
  const Eigen::Vector2d size = frame.upper - frame.lower;
  const double top = size.y() + picture_margin * places.side();
  const double width = size.x() / color_count;
  std::string scale;
  for (std::size_t color = 0; color < color_count; ++color) {
    scale += "<rect" + attribute("x", static_cast<double>(color) * width) + attribute("y", top) +
             attribute("width", scale_overlap * width) + attribute("height", scale_height * places.side()) +
             " fill=\"" + color_text(color) + "\"/>\n";
  }
  return scale + "<text x=\"0\"" + attribute("y", top + (scale_height + text_distance) * places.side()) +
         attribute("font-size", text_height * places.side()) +
         " font-family=\"sans-serif\" fill=\"#22313f\">strain from 0 to " +
         number_text(std::round(1e4 * frame.full_strain) / 100) + " % and more</text>\n";
}

}  // namespace

PictureFrame picture_frame(const tiling::PeriodicMesh& mesh, const std::vector<PartState>& states) {
  PictureFrame frame{mesh.nodes.rowwise().minCoeff(), mesh.nodes.rowwise().maxCoeff(), min_full_strain};
  for (const PartState& state : states) {
    const Eigen::Matrix2Xd moved = mesh.nodes + state.displacements;
    frame.lower = frame.lower.cwiseMin(moved.rowwise().minCoeff());
    frame.upper = frame.upper.cwiseMax(moved.rowwise().maxCoeff());
    frame.full_strain = std::max(frame.full_strain, usual_strain(triangle_strains(mesh, state.displacements)));
  }
  return frame;
}

std::string write_part_svg(const tiling::PeriodicMesh& mesh, const Eigen::Matrix2Xd& displacements,
                           const PictureFrame& frame) {
  const PicturePlaces places(frame);
  const std::vector<double> strains = triangle_strains(mesh, displacements);
  std::array<FileText, color_count> paths;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    FileText& path = paths[color_of(strains[t], frame)];
    char command = 'M';
    for (const std::size_t k : outline_order) {
      const int node = mesh.triangles[t][k];
      places.add(path, command, mesh.nodes.col(node) + displacements.col(node));
      command = 'L';
    }
    path << "Z\n";
  }
  const double margin = picture_margin * places.side();
  const double width = (frame.upper - frame.lower).x() + 2 * margin;
  const double height = (frame.upper - frame.lower).y() + 3 * margin + (scale_height + text_distance) * places.side();
  FileText out;
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\""
      << number_text(width) << "mm\" height=\"" << number_text(height) << "mm\" viewBox=\"" << number_text(-margin)
      << " " << number_text(-margin) << " " << number_text(width) << " " << number_text(height)
      << "\">\n<title>Deformed part</title>\n";
  for (std::size_t color = 0; color < color_count; ++color) {
    const std::string path = paths[color].take();
    if (path.empty()) continue;
    const std::string name = color_text(color);
    out << "<path fill=\"" << name << "\" stroke=\"" << name << "\" stroke-linejoin=\"round\""
        << attribute("stroke-width", seam_width * mesh.mesh_size) << " d=\"" << path << "\"/>\n";
  }
  out << color_scale(places, frame) << "</svg>\n";
  return out.take();
}

std::string write_part_obj(const tiling::PeriodicMesh& mesh, const Eigen::Matrix2Xd& displacements) {
  constexpr int parts[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
  FileText out;
  out << "o part\n";
  for (Eigen::Index node = 0; node < mesh.nodes.cols(); ++node) {
    out << "v ";
    out.point(Eigen::Vector2d(mesh.nodes.col(node) + displacements.col(node)));
  }
  for (const auto& triangle : mesh.triangles)
    for (const auto& corners : parts) {
      out << "f ";
      for (int k = 0; k < 3; ++k) out.number(triangle[static_cast<std::size_t>(corners[k])] + 1, k < 2 ? ' ' : '\n');
    }
  return out.take();
}

std::string write_part_csv(const std::vector<PartState>& states) {
  FileText out;
  out << "state,share";
  const std::size_t supports = states.empty() ? 0 : states.front().supports.size();
  for (std::size_t k = 0; k < supports; ++k)
    for (const char* name : {"displacement_x", "displacement_y", "force_x", "force_y", "touching"})
      out << "," << name << "_" << std::to_string(k);
  out << ",energy,largest_strain,contacts,stable,branch,stopped,residual,iterations,load_steps\n";
  for (std::size_t i = 0; i < states.size(); ++i) {
    const PartState& state = states[i];
    out.number(i, ',').number(state.fraction, ',');
    for (const SupportState& support : state.supports)
      out.number(support.displacement.x(), ',')
          .number(support.displacement.y(), ',')
          .number(support.force.x(), ',')
          .number(support.force.y(), ',')
          .number(support.touching, ',');
    out.number(state.energy, ',').number(state.largest_strain, ',').number(state.contacts, ',');
    out << (state.stable ? "true," : "false,");
    out.number(state.branch, ',') << to_string(state.stopped) << ",";
    if (std::isfinite(state.residual))
      out.number(state.residual, ',');
    else
      out << ",";
    out.number(state.iterations, ',').number(state.load_steps, '\n');
  }
  return out.take();
}

}  // namespace supple::microscale
