/// Prints Young's modulus and Poisson's ratio of a woven sheet in every direction.
///
///     homogenize_weave DIRECTIONS     their number over half a turn
#include <cstdlib>
#include <exception>
#include <iostream>

#include "supple/weave/patterns.h"
#include "supple/weave/shortcuts.h"

namespace {

void print_moduli(int directions) {
  using namespace supple;
  // Straight strands at right angles, 4 mm apart and fused at their crossings, stretched by 10 %.
  const weave::Weave grid = weave::regular_weave(weave::uniform_block(weave::Connection::fused), 4);
  const auto responses = weave::homogenize_over_half_turn(grid, directions, 0.1);
  for (const weave::DirectionalResponse& response : responses)
    std::cout << "direction " << response.direction << " rad: Young's modulus " << response.youngs_modulus
              << " N/m, Poisson's ratio " << response.poisson_ratio << ", " << to_string(response.state.stopped)
              << '\n';
  std::cout << "the sheet is "
            << weave::youngs_moduli(responses).maxCoeff() / weave::youngs_moduli(responses).minCoeff()
            << " times as stiff in one direction as in another\n";
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 2) {
    std::cerr << "usage: homogenize_weave DIRECTIONS\n";
    return 2;
  }
  print_moduli(std::atoi(arguments[1]));
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
