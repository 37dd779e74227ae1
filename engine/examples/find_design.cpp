/// Searches for a tiling whose stress follows a curve, with a trained network, and prints its parameters.
///
///     find_design MODEL       a model file, for example models/ih67.h5
#include <exception>
#include <iostream>

#include "supple/design/shortcuts.h"

namespace {

void print_design(const char* path) {
  using namespace supple;
  const neural::Model model = neural::read_model(path);

  // The target is a curve through control points (Green strain, stress in MPa) along a direction of 0.3 rad.
  design::Target target;
  target.task = design::Task::stress_strain;
  target.direction = 0.3;
  target.control_points = {{-0.1, -0.02}, {0.0, 0.0}, {0.1, 0.02}, {0.2, 0.12}};

  const design::Design found = design::find_design(model, {.targets = {target}, .initial = {}, .fixed = {}});
  std::cout << "family " << model.family << ", parameters " << found.parameters.transpose() << '\n'
            << "relative deviation " << found.error.relative_rms << (found.reached ? ", reached" : ", not reached")
            << '\n';
  const design::DesignProfile& profile = found.profiles.front();
  for (Eigen::Index i = 0; i < profile.achieved.size(); ++i)
    std::cout << "strain " << profile.target.samples.x[static_cast<std::size_t>(i)] << "  wanted "
              << profile.target.y[i] << " MPa  achieved " << profile.achieved[i] << " MPa\n";
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 2) {
    std::cerr << "usage: find_design MODEL\n";
    return 2;
  }
  print_design(arguments[1]);
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
