#include "support/parametric.h"

#include <map>
#include <tuple>

namespace supple::testing {

void Soup::add_quad(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d, bool from_b) {
  if (from_b) {
    faces.push_back({a, b, d});
    faces.push_back({b, c, d});
  } else {
    faces.push_back({a, b, c});
    faces.push_back({a, c, d});
  }
}

void Soup::append(const Soup& other, const Eigen::Vector3d& offset) {
  const auto first = static_cast<std::int32_t>(positions.size());
  for (const Eigen::Vector3d& p : other.positions) positions.emplace_back(p + offset);
  for (const auto& [a, b, c] : other.faces) faces.push_back({a + first, b + first, c + first});
}

Soup parametric_grid(int nu, int nv, Wrap wrap, const std::function<Eigen::Vector3d(int i, int j)>& at, bool from_b) {
  const int columns = wrap == Wrap::none ? nu + 1 : nu;
  const int rows = wrap == Wrap::both ? nv : nv + 1;
  Soup soup;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) soup.add(at(i, j));
  }
  const auto number = [&](int i, int j) { return (j % rows) * columns + i % columns; };
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      soup.add_quad(number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1), from_b);
    }
  }
  return soup;
}

Soup cell_surface(const Eigen::Vector3i& size, int n, const std::function<bool(int x, int y, int z)>& filled) {
  Soup soup;
  std::map<std::tuple<int, int, int>, std::int32_t> numbers;
  const auto vertex = [&](const Eigen::Vector3i& lattice) {
    const auto [it, is_new] = numbers.try_emplace({lattice[0], lattice[1], lattice[2]}, 0);
    if (is_new) it->second = soup.add(lattice.cast<double>() / n);
    return it->second;
  };
  const auto is_filled = [&](const Eigen::Vector3i& cell) {
    return (cell.array() >= 0).all() && (cell.array() < size.array()).all() && filled(cell[0], cell[1], cell[2]);
  };
  const auto add_side = [&](const Eigen::Vector3i& cell, int axis, bool upper) {
    const Eigen::Vector3i u = Eigen::Vector3i::Unit((axis + 1) % 3), v = Eigen::Vector3i::Unit((axis + 2) % 3);
    const Eigen::Vector3i corner = n * (cell + static_cast<int>(upper) * Eigen::Vector3i::Unit(axis));
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const Eigen::Vector3i at = corner + i * u + j * v;
        const std::int32_t a = vertex(at), b = vertex(at + u), c = vertex(at + u + v), d = vertex(at + v);
        if (upper) {
          soup.add_quad(a, b, c, d);
        } else {
          soup.add_quad(a, d, c, b);
        }
      }
    }
  };
  for (int z = 0; z < size[2]; ++z) {
    for (int y = 0; y < size[1]; ++y) {
      for (int x = 0; x < size[0]; ++x) {
        const Eigen::Vector3i cell(x, y, z);
        if (!is_filled(cell)) continue;
        for (int axis = 0; axis < 3; ++axis) {
          for (const bool upper : {false, true}) {
            if (!is_filled(cell + (upper ? 1 : -1) * Eigen::Vector3i::Unit(axis))) add_side(cell, axis, upper);
          }
        }
      }
    }
  }
  return soup;
}

void smooth(Soup& soup, int rounds) {
  const std::size_t n = soup.positions.size();
  for (int round = 0; round < rounds; ++round) {
    std::vector<Eigen::Vector3d> sums(n, Eigen::Vector3d::Zero());
    std::vector<int> counts(n, 0);
    for (const auto& face : soup.faces) {
      for (int i = 0; i < 3; ++i) {
        sums[face[i]] += soup.positions[face[(i + 1) % 3]];
        ++counts[face[i]];
      }
    }
    for (std::size_t v = 0; v < n; ++v) soup.positions[v] = 0.5 * (soup.positions[v] + sums[v] / counts[v]);
  }
}

}  // namespace supple::testing
