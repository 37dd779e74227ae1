#include "rod_elements.h"

#include <algorithm>
#include <stdexcept>

namespace supple::weave {

void link_edge(const RodModel& model, const Edge& edge, int first, Links& links) {
  for (int c = 0; c < model.dimension(); ++c) {
    links.push_back({model.position(edge.head) + c, first + c, 1});
    links.push_back({model.position(edge.tail) + c, first + c, -1});
  }
  if (edge.shift.isZero()) return;
  const Eigen::Vector2d translation = *model.weave().lattice * edge.shift.cast<double>();
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector2d moved = model.dyads()[static_cast<std::size_t>(k)] * translation;
    for (int c = 0; c < 2; ++c) links.push_back({model.strain() + k, first + c, moved[c]});
  }
}

void link_joint(const RodModel& model, int joint, int first, Links& links) {
  for (int c = 0; c < (model.spatial() ? 3 : 1); ++c) links.push_back({model.joint(joint) + c, first + c, 1});
}

void SliderSlots::add(const MaterialCoordinate& c) {
  for (const int slider : c.slider) {
    if (slider < 0 || std::find(slider_.begin(), slider_.begin() + count_, slider) != slider_.begin() + count_)
      continue;
    slider_[static_cast<std::size_t>(count_++)] = slider;
  }
}

double SliderSlots::weight(const MaterialCoordinate& c, int i) const {
  double sum = 0;
  for (std::size_t k = 0; k < 2; ++k)
    if (c.slider[k] >= 0 && c.slider[k] == slider_[static_cast<std::size_t>(i)]) sum += c.weight[k];
  return sum;
}

void SliderSlots::link(const RodModel& model, int first, Links& links) const {
  for (int i = 0; i < count_; ++i) links.push_back({model.slider(slider_[static_cast<std::size_t>(i)]), first + i, 1});
}

ElementRows::ElementRows(const Links& links) {
  for (const Link& link : links) {
    const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(count_);
    const auto place = std::lower_bound(rows_.begin(), end, link.dof);
    if (place != end && *place == link.dof) continue;
    if (count_ == rows_.size()) throw std::logic_error("an element of a rod has too many unknowns");
    std::copy_backward(place, end, end + 1);
    *place = link.dof;
    ++count_;
  }
  links_.reserve(links.size());
  for (const Link& link : links) {
    const auto row = std::ranges::lower_bound(rows(), link.dof) - rows().begin();
    links_.push_back({static_cast<std::size_t>(row), static_cast<std::size_t>(link.slot), link.coefficient});
  }
}

}  // namespace supple::weave
