#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "diagram_evaluator.h"
#include "supple/numerics/term.h"

namespace supple::voronoi {

/// Base class of the terms. The diagram of a state is evaluated once for all of them. Lengths are measured in units of
/// the mean cell size. A step moves no site farther than half of that.
class DiagramTerm : public numerics::Term<SitesState> {
 public:
  DiagramTerm(std::shared_ptr<const DiagramEvaluator> evaluator, double weight, double unit)
      : evaluator_(std::move(evaluator)), weight_(weight), unit_(unit) {}

  void prepare(SitesState& state, int order, const Execution& execution) override {
    evaluator_->evaluate(state, order, execution);
  }
  double largest_step(const SitesState& state, const Eigen::VectorXd& step) const override;

  /// Adds each cell's part of the term's energy to its entry. The parts sum up to the energy. A move of a site changes
  /// only those of its own cell and of the cells next to it, before or after the move.
  virtual void add_cell_energies(const SitesState& state, Eigen::VectorXd& energies) const = 0;

 protected:
  double weight() const { return weight_; }
  double unit() const { return unit_; }

 private:
  std::shared_ptr<const DiagramEvaluator> evaluator_;
  double weight_;
  double unit_;
};

/// (1/2) sum over edges of (g(x_i, x_j) - L)^2 [Thesis, eq. 3.29]. Gauss-Newton Hessian.
class EdgeLengthTerm : public DiagramTerm {
 public:
  EdgeLengthTerm(std::shared_ptr<const DiagramEvaluator> evaluator, double weight, double unit, double length)
      : DiagramTerm(std::move(evaluator), weight, unit), length_(length) {}
  std::string_view name() const override { return "edge_length"; }
  void add(const SitesState& state, int order, numerics::EnergySum& sum) const override;
  void add_cell_energies(const SitesState& state, Eigen::VectorXd& energies) const override;

 private:
  double length_;
};

/// (1/2) sum over cells of the mean squared distance of their vertices from the plane that fits them best [Thesis, eq.
/// 3.30]. A vertex has the weight of the half of the polygon's perimeter next to it: with equal weights the energy
/// would jump where a cell gains or loses a vertex, and searches would end there. The plane is eliminated by variable
/// projection: its part is projected out of the residuals' derivatives [Kaufman1975].
class PlanarityTerm : public DiagramTerm {
 public:
  using DiagramTerm::DiagramTerm;
  std::string_view name() const override { return "planarity"; }
  void add(const SitesState& state, int order, numerics::EnergySum& sum) const override;
  void add_cell_energies(const SitesState& state, Eigen::VectorXd& energies) const override;
};

/// (1/2) sum over cells and their vertices of g(s_i, x_j)^2 [Thesis, eq. 3.31]. Gauss-Newton Hessian.
class RegularityTerm : public DiagramTerm {
 public:
  using DiagramTerm::DiagramTerm;
  std::string_view name() const override { return "regularity"; }
  void add(const SitesState& state, int order, numerics::EnergySum& sum) const override;
  void add_cell_energies(const SitesState& state, Eigen::VectorXd& energies) const override;
};

/// (1/2) sum over cells of the integral of g(s_i, x)^2, which is minimal if the sites are centroids. The Hessian is
/// that of flat cells with fixed borders, as in Lloyd's algorithm.
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

/// The plane that fits points best: its centre is the points' weighted mean, and `distances` are those of the points
/// from it.
struct FittedPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d first = Eigen::Vector3d::Zero();  ///< `first` and `second` are axes in the plane
  Eigen::Vector3d second = Eigen::Vector3d::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::VectorXd distances;
};
/// `weights` must sum up to 1; without any, all points have the same weight.
FittedPlane fit_plane(const std::vector<Eigen::Vector3d>& points, const Eigen::VectorXd& weights = {});
/// The positions of a cell's vertices.
std::vector<Eigen::Vector3d> vertex_positions(const Diagram& diagram, const DiagramCell& cell);

}  // namespace supple::voronoi
