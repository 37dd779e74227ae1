#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "network_case.h"
#include "supple/base/random.h"

namespace supple::embedded {

/// How the springs of a random network are drawn.
struct RandomSprings {
  int points = 12;
  bool to_nearest = false;  ///< whether each point has springs to the four nearest others, or else to four random ones
  double shortest = 0.6;    ///< least ratio of a rest length to the length at the start
  double longest = 1.3;     ///< the largest such ratio
  int fixed = 3;
  double weight = 1;  ///< weights are from 0.5 to 2 times this
};

/// Gives a case a network of random points on its mesh. Four springs begin at each point; some are stretched, others
/// compressed.
template <class Case>
void draw_network(Case& hard, const RandomSprings& drawn, RandomStream& random) {
  const auto count = static_cast<std::size_t>(drawn.points);
  for (std::size_t i = 0; i < count; ++i) hard.network.points.push_back(testing::random_point(*hard.mesh, random));
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<std::pair<double, std::size_t>> others;
    for (std::size_t j = 0; j < count; ++j)
      if (j != i)
        others.emplace_back(drawn.to_nearest ? hard.solver.distance(hard.network.points[i], hard.network.points[j])
                                             : random.uniform(0, 1),
                            j);
    std::ranges::sort(others);
    for (std::size_t k = 0; k < 4; ++k) pairs.insert(std::minmax(i, others[k].second));
  }
  for (const auto& [a, b] : pairs) {
    const double length = hard.solver.distance(hard.network.points[a], hard.network.points[b]);
    const double rest = length * random.uniform(drawn.shortest, drawn.longest);
    hard.network.springs.push_back(
        {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), rest, drawn.weight * random.uniform(0.5, 2)});
  }
  for (std::int32_t i = 0; i < drawn.fixed; ++i) hard.network.fixed_points.push_back(i);
}

}  // namespace supple::embedded
