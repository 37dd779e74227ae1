// Compressed springs at their cut loci can stop the search of a whole network early. The answer is compared with that
// of a search that fixes the ends of these springs and moves the other points.
#include <iostream>

#include "random_springs.h"

namespace supple::embedded {
namespace {

/// The ends of compressed springs at their cut loci.
std::vector<std::int32_t> ends_at_cut_loci(const Network& network, const Relaxation& relaxed) {
  std::set<std::int32_t> ends;
  for (std::size_t i = 0; i < network.springs.size(); ++i)
    if (relaxed.springs[i].at_cut_locus && relaxed.springs[i].compressed)
      ends.insert({network.springs[i].from, network.springs[i].to});
  return {ends.begin(), ends.end()};
}

/// A square sheet whose vertices have random heights.
surface::TriangleMesh bumpy_sheet(int n, RandomStream& random) {
  const surface::TriangleMesh flat = testing::flat_grid(n, n);
  std::vector<Eigen::Vector3d> positions = flat.positions();
  for (Eigen::Vector3d& position : positions) position.z() += random.uniform(-1, 1) * flat.mean_edge_length();
  return surface::TriangleMesh::build(std::move(positions), flat.faces());
}

/// Searches an equilibrium, then again with the ends at cut loci fixed, which must not lower the energy.
void expect_no_jam(std::uint64_t seed, const RandomSprings& drawn) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  RandomStream random("jams", seed);
  NetworkCase hard(testing::torus(24, 12));
  draw_network(hard, drawn, random);
  const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
  EXPECT_TRUE(relaxed.stopped == RelaxationTermination::converged ||
              relaxed.stopped == RelaxationTermination::cut_locus)
      << to_string(relaxed.stopped);
  Network held = hard.network;
  held.points = relaxed.points;
  for (const std::int32_t end : ends_at_cut_loci(hard.network, relaxed)) held.fixed_points.push_back(end);
  std::ranges::sort(held.fixed_points);
  held.fixed_points.erase(std::unique(held.fixed_points.begin(), held.fixed_points.end()), held.fixed_points.end());
  const Relaxation others = relax(hard.solver, held, hard.options);
  EXPECT_GE(others.energy, relaxed.energy * (1 - 1e-5));
  for (std::size_t i = 1; i < relaxed.history.size(); ++i)
    EXPECT_LE(relaxed.history[i].energy, relaxed.history[i - 1].energy * (1 + 1e-12));
}

// Hard: one of eighty springs is at its cut locus, and steps that are good for all others increase its energy.
TEST(Jams, HoldingWhatJamsLowersNoEnergyAtTheEnd) {
  for (std::uint64_t seed = 0; seed < 12; ++seed)
    expect_no_jam(seed, {.points = 40, .to_nearest = true, .shortest = 0.8, .longest = 1.3, .fixed = 4});
}

// Hard: unless the ends of a compressed spring are fixed, it keeps the energy above what the other points could reach.
TEST(Jams, ANetworkThatOneSpringHoldsUpGetsOn) {
  expect_no_jam(24, {.points = 20, .to_nearest = true, .shortest = 0.8, .longest = 1.6, .fixed = 4});
}

// Hard: steps that oscillate across a ridge gain little each time, until the iteration limit.
TEST(Jams, RidgesAreLeftOrNamed) {
  int unfinished = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    RandomStream random("ridges", seed);
    const bool is_torus = seed % 2 == 0;
    NetworkCase hard(is_torus ? testing::torus(9, 5) : testing::icosphere(1));
    draw_network(hard, {.points = 14, .shortest = 0.6, .longest = 1.3, .fixed = 2}, random);
    const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
    if (relaxed.stopped != RelaxationTermination::converged && relaxed.stopped != RelaxationTermination::cut_locus) {
      ++unfinished;
      std::cout << "seed " << seed << " " << to_string(relaxed.stopped) << "\n";
    }
  }
  EXPECT_LE(unfinished, 1);
}

// Hard: many passes of fixing and releasing points lower the energy by less than a hundredth each. A search that ends
// after some of them is not at a minimum.
TEST(Jams, AnAnswerAtACutLocusIsNotLeftByAskingAgain) {
  int jammed = 0;
  for (std::uint64_t seed = 0; seed < 15; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomStream random("asked again", seed);
    NetworkCase hard(bumpy_sheet(5 + static_cast<int>(seed % 3), random));
    // With the mollifier a search that starts at an answer would begin with another energy than that answer's.
    hard.options.mollifier = Switch::off;
    draw_network(hard, {.points = 16, .shortest = 0.5, .longest = seed / 3 % 2 == 0 ? 1.3 : 1.6, .fixed = 2}, random);
    const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
    if (relaxed.stopped != RelaxationTermination::cut_locus) continue;
    ++jammed;
    hard.network.points = relaxed.points;
    const Relaxation again = relax(hard.solver, hard.network, hard.options);
    EXPECT_GE(again.energy, relaxed.energy * (1 - 1e-5));
  }
  EXPECT_GT(jammed, 1);
}

}  // namespace
}  // namespace supple::embedded
