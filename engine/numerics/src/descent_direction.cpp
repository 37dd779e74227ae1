#include "descent_direction.h"

#include <cmath>
#include <utility>
#include <vector>

#include "supple/numerics/cholesky.h"

namespace supple::numerics {
namespace {

/// A pair (s, y) shows positive curvature if s . y > this * |s| |y|. Other pairs would spoil the approximation.
constexpr double min_curvature_cosine = 1e-10;

bool shows_curvature(const Eigen::VectorXd& s, const Eigen::VectorXd& y) {
  return s.dot(y) > min_curvature_cosine * s.norm() * y.norm();
}

class NewtonDirection : public DescentDirection {
 public:
  NewtonDirection(const MinimizerOptions& options, ShiftedCholesky* shared, const CancellationToken& cancellation)
      : options_(options),
        own_(shared ? nullptr : std::make_unique<ShiftedCholesky>()),
        cholesky_(shared ? *shared : *own_) {
    cholesky_.stop_with(cancellation);
  }

  int order() const override { return 2; }

  // A regularized factorization belongs to another matrix, so that its steps converge too slowly for a second use.
  bool reuses_factorization(double contraction) const override {
    return !uses_modified_hessian() && contraction <= options_.reuse_contraction;
  }

  Eigen::VectorXd direction(const Evaluation& evaluation, Objective& objective) override {
    if (std::holds_alternative<std::monostate>(evaluation.hessian)) {
      Eigen::VectorXd d = -cholesky_.solve(evaluation.gradient);
      if (d.allFinite() && evaluation.gradient.dot(d) < 0) return d;
      return {};
    }
    scale_ = matrix_scale(evaluation.hessian);
    used_convex_hessian_ = false;
    std::optional<Hessian> convex_hessian;
    for (; relative_ <= options_.max_regularization; raise()) {
      bool factorized = cholesky_.factorize(convex_hessian ? *convex_hessian : evaluation.hessian, regularization());
      if (!factorized && !convex_hessian) {
        indefinite_ = indefinite_ || relative_ == 0;
        convex_hessian = objective.convex_hessian();
        used_convex_hessian_ = convex_hessian.has_value();
        factorized = convex_hessian && cholesky_.factorize(*convex_hessian, regularization());
      }
      if (!factorized) continue;
      Eigen::VectorXd d = -cholesky_.solve(evaluation.gradient);
      if (d.allFinite() && evaluation.gradient.dot(d) < 0) return d;
    }
    // The next state may be better conditioned, so its search starts with the smallest regularization again.
    relative_ = 0;
    return {};
  }

  bool retry() override {
    raise();
    if (relative_ <= options_.max_regularization) return true;
    relative_ = 0;
    return false;
  }

  void accepted(bool first_trial, const Eigen::VectorXd&, const Eigen::VectorXd&, const Eigen::VectorXd&) override {
    if (!first_trial) return;
    relative_ *= options_.lower;
    if (relative_ < options_.first_regularization) relative_ = 0;
  }

  double regularization() const override { return relative_ * scale_; }
  bool uses_modified_hessian() const override { return relative_ > 0 || used_convex_hessian_; }
  bool met_indefinite() const override { return indefinite_; }

 private:
  void raise() { relative_ = relative_ > 0 ? relative_ * options_.raise : options_.first_regularization; }

  const MinimizerOptions& options_;
  std::unique_ptr<ShiftedCholesky> own_;
  ShiftedCholesky& cholesky_;
  double relative_ = 0;
  double scale_ = 1;
  bool indefinite_ = false;
  bool used_convex_hessian_ = false;  ///< whether the last direction was computed with the objective's convex Hessian
};

class LbfgsDirection : public DescentDirection {
 public:
  explicit LbfgsDirection(const MinimizerOptions& options) : options_(options) {}

  int order() const override { return 1; }

  Eigen::VectorXd direction(const Evaluation& evaluation, Objective&) override {
    Eigen::VectorXd d = evaluation.gradient;
    std::vector<double> alpha(pairs_.size());
    for (std::size_t i = pairs_.size(); i-- > 0;) {
      const auto& [s, y] = pairs_[i];
      alpha[i] = s.dot(d) / s.dot(y);
      d -= alpha[i] * y;
    }
    if (pairs_.empty()) {
      d *= options_.first_step;
    } else {
      const auto& [s, y] = pairs_.back();
      d *= s.dot(y) / y.squaredNorm();
    }
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto& [s, y] = pairs_[i];
      d += (alpha[i] - y.dot(d) / s.dot(y)) * s;
    }
    d = -d;
    if (d.allFinite() && evaluation.gradient.dot(d) < 0) return d;
    pairs_.clear();
    return -options_.first_step * evaluation.gradient;
  }

  bool retry() override {
    if (pairs_.empty()) return false;
    pairs_.clear();
    return true;
  }

  void accepted(bool, const Eigen::VectorXd& step, const Eigen::VectorXd& old_gradient,
                const Eigen::VectorXd& new_gradient) override {
    Eigen::VectorXd y = new_gradient - old_gradient;
    if (!shows_curvature(step, y)) return;
    pairs_.emplace_back(step, std::move(y));
    if (pairs_.size() > static_cast<std::size_t>(options_.lbfgs_history)) pairs_.pop_front();
  }

  void transport(const Objective& objective) override {
    for (auto& [s, y] : pairs_) {
      objective.transport(s);
      objective.transport(y);
    }
  }

  void forget() override { pairs_.clear(); }

 private:
  const MinimizerOptions& options_;
  std::deque<std::pair<Eigen::VectorXd, Eigen::VectorXd>> pairs_;
};

class GradientDirection : public DescentDirection {
 public:
  explicit GradientDirection(const MinimizerOptions& options) : options_(options), length_(options.first_step) {}

  int order() const override { return 1; }
  Eigen::VectorXd direction(const Evaluation& evaluation, Objective&) override {
    return -length_ * evaluation.gradient;
  }

  bool retry() override {
    const bool learned = length_ != options_.first_step;
    forget();
    return learned;
  }

  void accepted(bool, const Eigen::VectorXd& step, const Eigen::VectorXd& old_gradient,
                const Eigen::VectorXd& new_gradient) override {
    const Eigen::VectorXd y = new_gradient - old_gradient;
    if (!shows_curvature(step, y)) return forget();
    // Alternating between the long and the short step length is more robust than either of them [Dai2005].
    length_ = use_long_ ? step.squaredNorm() / step.dot(y) : step.dot(y) / y.squaredNorm();
    use_long_ = !use_long_;
  }

  void forget() override { length_ = options_.first_step; }

 private:
  const MinimizerOptions& options_;
  double length_;
  bool use_long_ = true;
};

}  // namespace

std::unique_ptr<DescentDirection> make_descent_direction(const MinimizerOptions& options,
                                                         ShiftedCholesky* factorization,
                                                         const CancellationToken& cancellation) {
  switch (options.method) {
    case MinimizerMethod::newton:
      return std::make_unique<NewtonDirection>(options, factorization, cancellation);
    case MinimizerMethod::lbfgs:
      return std::make_unique<LbfgsDirection>(options);
    case MinimizerMethod::gradient_descent:
      break;
  }
  return std::make_unique<GradientDirection>(options);
}

}  // namespace supple::numerics
