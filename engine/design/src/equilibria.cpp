#include "equilibria.h"

#include <algorithm>
#include <utility>

namespace supple::design {

template <class Real>
Equilibria<Real>::Equilibria(const Evaluator& evaluator, const std::vector<Loading>& loads,
                             const neural::UniaxialOptions& options)
    : evaluator_(evaluator) {
  samples_.reserve(loads.size());
  for (const Loading& load : loads)
    samples_.push_back({neural::UniaxialNewton(neural::UniaxialFrame(load.direction), options), load, {}});
}

template <class Real>
bool Equilibria<Real>::from_rest(const typename Evaluator::Design& design) {
  const Equilibrium rest = rest_state(design);
  for (Sample& sample : samples_) start_from_rest(sample, rest);
  return run(design);
}

template <class Real>
bool Equilibria<Real>::follow(const typename Evaluator::Design& design, const Eigen::VectorXd& change, double turn) {
  std::vector<Eigen::Vector2d> steps;
  steps.reserve(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    steps.emplace_back(sensitivity(i) * change);
    // If the material turns by an angle, the load's direction turns by the opposite angle relative to it.
    if (turn != 0) steps.back() -= direction_sensitivity(i) * turn;
  }
  if (turn != 0) turn_to(orientation_ + turn);
  for (std::size_t i = 0; i < samples_.size(); ++i)
    samples_[i].newton.start_in_one_increment(samples_[i].load.strain, steps[i]);
  if (run(design)) return true;
  const Equilibrium rest = rest_state(design);
  for (Sample& sample : samples_) {
    if (sample.newton.converged()) continue;
    start_from_rest(sample, rest);
    ++restarts_;
  }
  return run(design);
}

template <class Real>
Eigen::Matrix2Xd Equilibria<Real>::sensitivity(std::size_t i) const {
  const Sample& sample = samples_[i];
  const auto& free = sample.newton.frame().free;
  const Eigen::Matrix2d h = free.transpose() * sample.state.tangent * free;
  const Eigen::Matrix2Xd right_hand_sides = free.transpose() * sample.state.stress_by_parameters;
  Eigen::Matrix2Xd result(2, right_hand_sides.cols());
  for (Eigen::Index p = 0; p < right_hand_sides.cols(); ++p)
    result.col(p) = -neural::convex_solve(h, right_hand_sides.col(p));
  return result;
}

template <class Real>
Eigen::Vector2d Equilibria<Real>::direction_sensitivity(std::size_t i) const {
  const Sample& sample = samples_[i];
  const auto& frame = sample.newton.frame();
  const auto slope = frame.slope();
  const Eigen::Matrix2d h = frame.free.transpose() * sample.state.tangent * frame.free;
  const Eigen::Vector3d strain_rate = slope.strain(sample.load.strain, sample.newton.free_strains());
  return -neural::convex_solve(
      h, slope.free.transpose() * sample.state.stress + frame.free.transpose() * sample.state.tangent * strain_rate);
}

template <class Real>
void Equilibria<Real>::orient(double orientation) {
  if (orientation != orientation_) turn_to(orientation);
}

template <class Real>
void Equilibria<Real>::turn_to(double orientation) {
  orientation_ = orientation;
  for (Sample& sample : samples_) sample.newton.turn(neural::UniaxialFrame(sample.load.direction - orientation));
}

template <class Real>
void Equilibria<Real>::start_from_rest(Sample& sample, const Equilibrium& rest) {
  sample.state = rest;
  sample.newton.start_from_rest(rest);
  sample.newton.go_to(sample.load.strain);
}

template <class Real>
Equilibrium Equilibria<Real>::rest_state(const typename Evaluator::Design& design) {
  strains_.setZero(3, 1);
  evaluator_.evaluate(design, strains_, neural::Order::tangent, workspace_, evaluation_);
  ++evaluations_;
  Equilibrium rest;
  read(0, rest);
  return rest;
}

template <class Real>
bool Equilibria<Real>::run(const typename Evaluator::Design& design) {
  std::vector<std::size_t> active;
  Equilibrium trial;
  while (true) {
    cancellation_.throw_if_requested();
    active.clear();
    for (std::size_t i = 0; i < samples_.size(); ++i)
      if (samples_[i].newton.working()) active.push_back(i);
    if (active.empty()) break;
    strains_.resize(3, static_cast<Eigen::Index>(active.size()));
    for (std::size_t k = 0; k < active.size(); ++k)
      strains_.col(static_cast<Eigen::Index>(k)) = samples_[active[k]].newton.trial();
    evaluator_.evaluate(design, strains_, neural::Order::tangent, workspace_, evaluation_);
    evaluations_ += strains_.cols();
    for (std::size_t k = 0; k < active.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      Sample& sample = samples_[active[k]];
      trial.strain = strains_.col(column);
      read(column, trial);
      if (sample.newton.receive(trial)) std::swap(sample.state, trial);
      sample.state.converged = sample.newton.converged();
      sample.state.residual = sample.newton.residual();
    }
  }
  return std::all_of(samples_.begin(), samples_.end(), [](const Sample& s) { return s.newton.converged(); });
}

template <class Real>
void Equilibria<Real>::read(Eigen::Index column, Equilibrium& state) const {
  state.energy_density = evaluation_.energy_density[column];
  state.stress = evaluation_.stress.col(column);
  state.tangent = neural::symmetric_matrix(evaluation_.tangent.col(column));
  // In a column of the evaluation, the parameters of one stress component are consecutive.
  const Eigen::Index parameters = evaluation_.stress_by_parameters.rows() / 3;
  state.stress_by_parameters.resize(3, parameters);
  for (Eigen::Index row = 0; row < 3; ++row)
    for (Eigen::Index p = 0; p < parameters; ++p)
      state.stress_by_parameters(row, p) = evaluation_.stress_by_parameters(row * parameters + p, column);
}

template class Equilibria<double>;
template class Equilibria<float>;

}  // namespace supple::design
