#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "diagram_finder.h"
#include "supple/numerics/term.h"

namespace supple::voronoi {

/// What the terms have in common: the diagram of the state is found once for all of them, and lengths count in units of
/// the mean cell size. A step moves no site farther than half of that.
class DiagramTerm : public numerics::Term<SitesState> {
 public:
  DiagramTerm(std::shared_ptr<const DiagramFinder> finder, double weight, double unit)
      : finder_(std::move(finder)), weight_(weight), unit_(unit) {}

  void prepare(SitesState& state, int order, const Execution& execution) override {
    finder_->find(state, order, execution);
  }
  double largest_step(const SitesState& state, const Eigen::VectorXd& step) const override;

  /// Adds to each cell's entry its share of the energy of the diagram at this state. The shares add up to the energy,
  /// and those of cells that are neither a moved site's nor next to it, before or after, stay as they are.
  virtual void add_cell_energies(const SitesState& state, Eigen::VectorXd& energies) const = 0;

 protected:
  double weight() const { return weight_; }
  double unit() const { return unit_; }

 private:
  std::shared_ptr<const DiagramFinder> finder_;
  double weight_;
  double unit_;
};

/// (1/2) sum over edges of (g(x_i, x_j) - L)^2 (thesis eq. 3.29). Gauss-Newton Hessian.
class EdgeLengthTerm : public DiagramTerm {
 public:
  EdgeLengthTerm(std::shared_ptr<const DiagramFinder> finder, double weight, double unit, double length)
      : DiagramTerm(std::move(finder), weight, unit), length_(length) {}
  std::string_view name() const override { return "edge_length"; }
  void add(const SitesState& state, int order, numerics::EnergySum& sum) const override;
  void add_cell_energies(const SitesState& state, Eigen::VectorXd& energies) const override;

 private:
  double length_;
};

/// (1/2) sum over cells of the mean squared distance of their vertices from the plane that fits them best (thesis eq.
/// 3.30), each vertex weighted by the half of the polygon's perimeter next to it: with equal weights the energy would
/// jump where a cell gains or loses a vertex, and searches would end there. The plane is eliminated: its part of the
/// residuals' derivatives is projected out (Kaufman 1975).
class PlanarityTerm : public DiagramTerm {
 public:
  using DiagramTerm::DiagramTerm;
  std::string_view name() const override { return "planarity"; }
  void add(const SitesState& state, int order, numerics::EnergySum& sum) const override;
  void add_cell_energies(const SitesState& state, Eigen::VectorXd& energies) const override;
};

/// (1/2) sum over cells and their vertices of g(s_i, x_j)^2 (thesis eq. 3.31). Gauss-Newton Hessian.
class RegularityTerm : public DiagramTerm {
 public:
  using DiagramTerm::DiagramTerm;
  std::string_view name() const override { return "regularity"; }
  void add(const SitesState& state, int order, numerics::EnergySum& sum) const override;
  void add_cell_energies(const SitesState& state, Eigen::VectorXd& energies) const override;
};

/// (1/2) sum over cells of the integral of g(s_i, x)^2, least where sites are centroids. Hessian of flat cells that
/// keep their borders, Lloyd's.
class CentroidalTerm : public DiagramTerm {
 public:
  using DiagramTerm::DiagramTerm;
  std::string_view name() const override { return "centroidal"; }
  void add(const SitesState& state, int order, numerics::EnergySum& sum) const override;
  void add_cell_energies(const SitesState& state, Eigen::VectorXd& energies) const override;
};

/// (1/2) sum over cells of (A_i - mean)^2. Gauss-Newton Hessian.
class EqualAreaTerm : public DiagramTerm {
 public:
  using DiagramTerm::DiagramTerm;
  std::string_view name() const override { return "equal_area"; }
  void add(const SitesState& state, int order, numerics::EnergySum& sum) const override;
  void add_cell_energies(const SitesState& state, Eigen::VectorXd& energies) const override;
};

/// The plane that fits points best: through their centroid, and the distances of the points from it.
struct FittedPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d first = Eigen::Vector3d::Zero();  ///< axes in the plane
  Eigen::Vector3d second = Eigen::Vector3d::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::VectorXd distances;
};
/// `weights` are of sum 1; without any all are equal.
FittedPlane fit_plane(const std::vector<Eigen::Vector3d>& points, const Eigen::VectorXd& weights = {});
/// Where the vertices of a cell are.
std::vector<Eigen::Vector3d> vertex_positions(const Diagram& diagram, const DiagramCell& cell);

}  // namespace supple::voronoi
