#include <algorithm>
#include <cmath>
#include <sstream>

#include "supple/embedded/export.h"

namespace supple::embedded {
namespace {

// Sizes in the picture, in pixels.
constexpr double diagram_width = 640;
constexpr double panel_height = 200;
constexpr double left_edge = 84;
constexpr double right_edge = 20;
constexpr double top_edge = 34;
constexpr double panel_gap = 46;
constexpr double bottom_edge = 46;
constexpr double mark_radius = 2.5;

constexpr std::size_t max_marks = 200;  // a curve with more points is drawn without marks
constexpr int max_labels = 8;           // along an axis

/// The decades of a logarithmic axis.
struct Decades {
  int first = 0;
  int last = 1;
};

bool has_logarithm(double value) { return value > 0 && std::isfinite(value); }

Decades decades_of(const std::vector<RelaxationStep>& history, double RelaxationStep::*value) {
  Decades decades;
  bool any = false;
  for (const auto& step : history) {
    if (!has_logarithm(step.*value)) continue;
    const double decade = std::log10(step.*value);
    const int below = static_cast<int>(std::floor(decade));
    const int above = static_cast<int>(std::ceil(decade));
    decades.first = any ? std::min(decades.first, below) : below;
    decades.last = any ? std::max(decades.last, above) : above;
    any = true;
  }
  if (decades.last == decades.first) ++decades.last;
  return decades;
}

/// The distance between an axis's labels, which gives about max_labels at most: 1, 2 or 5 times a power of ten.
int label_step(int range) {
  int step = 1;
  for (int k = 0; step * max_labels < range; ++k) step = k % 3 == 1 ? step / 2 * 5 : step * 2;
  return step;
}

class ConvergenceDiagram {
 public:
  explicit ConvergenceDiagram(const std::vector<RelaxationStep>& history)
      : history_(history), iterations_(std::max(1, static_cast<int>(history.size()) - 1)) {
    svg_.precision(6);
  }

  std::string draw() {
    const double height = top_edge + 2 * panel_height + panel_gap + bottom_edge;
    svg_
        << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << diagram_width << ' ' << height << "\" width=\""
        << diagram_width << "\" height=\"" << height
        << "\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
    panel(top_edge, "energy", &RelaxationStep::energy, "#3a6ea5");
    panel(top_edge + panel_height + panel_gap, "gradient norm", &RelaxationStep::gradient_norm, "#b03030");
    text(left_edge + 0.5 * width(), height - 10, "middle", "iteration");
    svg_ << "</svg>\n";
    return svg_.str();
  }

 private:
  static double width() { return diagram_width - left_edge - right_edge; }
  double x_of(std::size_t iteration) const {
    return left_edge + width() * static_cast<double>(iteration) / iterations_;
  }

  void text(double x, double y, const char* anchor, const std::string& words) {
    svg_ << "<text x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\" fill=\"#333333\">" << words
         << "</text>\n";
  }

  void line(double x1, double y1, double x2, double y2) {
    svg_ << "<path stroke=\"#dddddd\" d=\"M" << x1 << ' ' << y1 << 'L' << x2 << ' ' << y2 << "\"/>\n";
  }

  void panel(double top, const char* title, double RelaxationStep::*value, const char* colour) {
    const auto decades = decades_of(history_, value);
    const int range = decades.last - decades.first;
    const auto y_of = [&](double decade) { return top + panel_height * (decades.last - decade) / range; };
    for (int decade = decades.first; decade <= decades.last; decade += label_step(range)) {
      line(left_edge, y_of(decade), left_edge + width(), y_of(decade));
      text(left_edge - 8, y_of(decade) + 4, "end", "1e" + std::to_string(decade));
    }
    for (int iteration = 0; iteration <= iterations_; iteration += label_step(iterations_)) {
      const double x = x_of(static_cast<std::size_t>(iteration));
      line(x, top, x, top + panel_height);
      text(x, top + panel_height + 16, "middle", std::to_string(iteration));
    }
    text(left_edge, top - 10, "start", title);
    curve(value, y_of, colour);
  }

  template <class VerticalPosition>
  void curve(double RelaxationStep::*value, VerticalPosition y_of, const char* colour) {
    std::ostringstream path;
    std::ostringstream marks;
    bool pen_down = false;
    for (std::size_t i = 0; i < history_.size(); ++i) {
      const double magnitude = history_[i].*value;
      if (has_logarithm(magnitude)) {
        const double y = y_of(std::log10(magnitude));
        path << (pen_down ? 'L' : 'M') << x_of(i) << ' ' << y;
        marks << "<circle cx=\"" << x_of(i) << "\" cy=\"" << y << "\" r=\"" << mark_radius << "\"/>\n";
      }
      pen_down = has_logarithm(magnitude);
    }
    svg_ << "<path fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"1.5\" d=\"" << path.str() << "\"/>\n";
    if (history_.size() <= max_marks) svg_ << "<g fill=\"" << colour << "\">\n" << marks.str() << "</g>\n";
  }

  const std::vector<RelaxationStep>& history_;
  int iterations_;
  std::ostringstream svg_;
};

}  // namespace

std::string write_convergence_svg(const std::vector<RelaxationStep>& history) {
  return ConvergenceDiagram(history).draw();
}

}  // namespace supple::embedded
