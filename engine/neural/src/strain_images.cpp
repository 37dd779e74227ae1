#include "strain_images.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace supple::neural {
namespace {

/// The indices of the components of a symmetric tensor of the given order in three dimensions, in the order of
/// `Evaluation`.
template <std::size_t order>
std::vector<std::array<int, order>> components() {
  std::vector<std::array<int, order>> all;
  std::array<int, order> index{};
  for (;;) {
    if (std::is_sorted(index.begin(), index.end())) all.push_back(index);
    std::size_t digit = order;
    while (digit > 0 && index[digit - 1] == 2) index[--digit] = 0;
    if (digit == 0) return all;
    ++index[digit - 1];
  }
}

/// The matrix of D'_ij... = T_ai T_bj ... D_ab... as a map between components.
template <std::size_t order>
Eigen::MatrixXd pulled_back(const Eigen::Matrix3d& t) {
  const auto all = components<order>();
  const auto n = static_cast<long>(all.size());
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(n, n);
  for (long row = 0; row < n; ++row) {
    std::array<int, order> index{};
    for (;;) {
      double product = 1;
      for (std::size_t k = 0; k < order; ++k) product *= t(index[k], all[static_cast<std::size_t>(row)][k]);
      auto sorted = index;
      std::sort(sorted.begin(), sorted.end());
      map(row, std::find(all.begin(), all.end(), sorted) - all.begin()) += product;
      std::size_t digit = order;
      while (digit > 0 && index[digit - 1] == 2) index[--digit] = 0;
      if (digit == 0) break;
      ++index[digit - 1];
    }
  }
  return map;
}

/// Adds the weighted results of one image, whose columns begin at `first`, to the answer. `map` pulls back the
/// components. A row of the results is a component, or a component and a parameter.
template <class Map, class Images, class Answer>
void add(const Map& map, const Images& images, long first, double weight, Answer& answer) {
  if (answer.size() == 0) return;
  const long components = map.rows();
  const long inner = answer.rows() / components;
  using Rows = Eigen::Map<Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;
  using ConstRows = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;
  const Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic> stride(answer.rows(), inner);
  for (long k = 0; k < inner; ++k)
    Rows(answer.data() + k, components, answer.cols(), stride).noalias() +=
        weight *
        map.lazyProduct(ConstRows(images.data() + first * images.rows() + k, components, answer.cols(), stride));
}

}  // namespace

StrainImages::StrainImages(const std::vector<Eigen::Matrix3d>& maps) {
  if (maps.empty()) return;
  pullbacks_.reserve(maps.size() + 1);
  const auto append = [&](const Eigen::Matrix3d& t) {
    pullbacks_.push_back({t, pulled_back<1>(t), pulled_back<2>(t), pulled_back<3>(t)});
  };
  append(Eigen::Matrix3d::Identity());
  for (const auto& map : maps) append(map);
}

void StrainImages::map_strains(const Eigen::Ref<const Eigen::Matrix3Xd>& strains, Eigen::Matrix3Xd& images) const {
  const long n = strains.cols();
  images.resize(3, n * static_cast<long>(pullbacks_.size()));
  long first = 0;
  for (const auto& [map, stress, tangent, third] : pullbacks_) {
    images.middleCols(first, n).noalias() = map.lazyProduct(strains);
    first += n;
  }
}

void StrainImages::average(const Evaluation& of_images, long strains, Evaluation& answer) const {
  const auto clear = [&](const auto& images, auto& part) {
    part.setZero(images.rows(), images.size() > 0 ? strains : 0);
  };
  clear(of_images.energy_density, answer.energy_density);
  clear(of_images.stress, answer.stress);
  clear(of_images.tangent, answer.tangent);
  clear(of_images.third, answer.third);
  clear(of_images.energy_by_parameters, answer.energy_by_parameters);
  clear(of_images.stress_by_parameters, answer.stress_by_parameters);
  clear(of_images.tangent_by_parameters, answer.tangent_by_parameters);
  const double weight = 1 / static_cast<double>(pullbacks_.size());
  const Eigen::Matrix<double, 1, 1> identity(1);
  long first = 0;
  for (const auto& [map, stress, tangent, third] : pullbacks_) {
    add(identity, of_images.energy_density, first, weight, answer.energy_density);
    add(stress, of_images.stress, first, weight, answer.stress);
    add(tangent, of_images.tangent, first, weight, answer.tangent);
    add(third, of_images.third, first, weight, answer.third);
    add(identity, of_images.energy_by_parameters, first, weight, answer.energy_by_parameters);
    add(stress, of_images.stress_by_parameters, first, weight, answer.stress_by_parameters);
    add(tangent, of_images.tangent_by_parameters, first, weight, answer.tangent_by_parameters);
    first += strains;
  }
}

}  // namespace supple::neural
