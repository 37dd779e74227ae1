/// Stretches one periodic cell of a tiling and prints the averaged stress and the tangent stiffness of every state.
///
///     homogenize_tiling FAMILY        for example IH21; the parameters are the family's defaults
#include <exception>
#include <iostream>

#include "supple/microscale/simulation.h"
#include "supple/tiling/structure.h"

namespace {

void print_response(const char* family) {
  using namespace supple;
  const tiling::Structure structure = tiling::make_structure(family);
  std::cout << "relative density " << structure.solid_area / structure.cell_area << '\n';

  // Elements are half as wide as a beam. The load stretches the material along x; lateral strain and shear are free.
  microscale::SimulationOptions options;
  options.mesh.mesh_size = 0.5;
  const microscale::UniaxialLoad load{
      .direction = 0, .stretches = {1.01, 1.02}, .frame = microscale::LoadFrame::material};
  const microscale::SimulationResult result = microscale::simulate(structure, load, options);
  for (const microscale::State& state : result.states)
    std::cout << "Green strain " << state.green_strain.transpose() << "\nstress, MPa " << state.stress.transpose()
              << "\ntangent stiffness, MPa\n"
              << state.tangent << '\n';
  if (!result.message.empty()) std::cout << result.message << '\n';
  std::cout << result.states.size() << " states, the last one " << to_string(result.states.back().stopped) << '\n';
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 2) {
    std::cerr << "usage: homogenize_tiling FAMILY\n";
    return 2;
  }
  print_response(arguments[1]);
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
