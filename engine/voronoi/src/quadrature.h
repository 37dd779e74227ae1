#pragma once

#include <array>

namespace supple::voronoi {

/// Nodes and weights of Gauss-Legendre quadrature on [0, 1], exact for polynomials of degree 5 and 9.
inline constexpr std::array<double, 3> three_nodes{0.1127016653792583, 0.5, 0.8872983346207417};
inline constexpr std::array<double, 3> three_weights{5.0 / 18, 8.0 / 18, 5.0 / 18};
inline constexpr std::array<double, 5> five_nodes{0.046910077030668, 0.2307653449471585, 0.5, 0.7692346550528415,
                                                  0.953089922969332};
inline constexpr std::array<double, 5> five_weights{0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                                    0.2393143352496832, 0.1184634425280945};

}  // namespace supple::voronoi
