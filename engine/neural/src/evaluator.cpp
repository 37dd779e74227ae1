#include "supple/neural/evaluator.h"

#include <algorithm>
#include <string>

#include "evaluation_pass.h"
#include "evaluator_content.h"
#include "strain_images.h"
#include "supple/base/error.h"

namespace supple::neural {

template <class Real>
struct BasicEvaluator<Real>::Content : PackedNetwork<Real> {
  explicit Content(const Network& of) : PackedNetwork<Real>(of), images(of.symmetries) {}

  StrainImages images;
};
template <class Real>
struct BasicEvaluator<Real>::Design::Content : PackedDesign<Real> {};
template <class Real>
struct BasicEvaluator<Real>::Workspace::Content : PassSpace<Real> {
  Eigen::Matrix3Xd images;
  Evaluation of_images;
};

template <class Real>
BasicEvaluator<Real>::BasicEvaluator(const Network& network) {
  validate(network);
  content_ = std::make_unique<const Content>(network);
}
template <class Real>
BasicEvaluator<Real>::~BasicEvaluator() = default;
template <class Real>
BasicEvaluator<Real>::BasicEvaluator(BasicEvaluator&&) noexcept = default;
template <class Real>
BasicEvaluator<Real>& BasicEvaluator<Real>::operator=(BasicEvaluator&&) noexcept = default;
template <class Real>
BasicEvaluator<Real>::Design::Design() : content_(std::make_unique<Content>()) {}
template <class Real>
BasicEvaluator<Real>::Design::~Design() = default;
template <class Real>
BasicEvaluator<Real>::Design::Design(Design&&) noexcept = default;
template <class Real>
typename BasicEvaluator<Real>::Design& BasicEvaluator<Real>::Design::operator=(Design&&) noexcept = default;
template <class Real>
BasicEvaluator<Real>::Workspace::Workspace() : content_(std::make_unique<Content>()) {}
template <class Real>
BasicEvaluator<Real>::Workspace::~Workspace() = default;
template <class Real>
BasicEvaluator<Real>::Workspace::Workspace(Workspace&&) noexcept = default;
template <class Real>
typename BasicEvaluator<Real>::Workspace& BasicEvaluator<Real>::Workspace::operator=(Workspace&&) noexcept = default;

template <class Real>
const NetworkShape& BasicEvaluator<Real>::shape() const {
  return content_->network.shape;
}

template <class Real>
double BasicEvaluator<Real>::Design::rest_stiffness() const {
  return content_->exact.stiffness;
}

template <class Real>
typename BasicEvaluator<Real>::Design BasicEvaluator<Real>::design(std::span<const double> parameters,
                                                                   bool with_parameter_derivatives) const {
  const int n = shape().parameters;
  if (static_cast<int>(parameters.size()) != n)
    throw Error("model.parameter_count",
                "The model has " + std::to_string(n) + " parameters, got " + std::to_string(parameters.size()) + ".",
                {{"parameters", std::to_string(n) + " numbers"}});
  Design design;
  static_cast<PackedDesign<Real>&>(*design.content_) = {*content_, parameters, with_parameter_derivatives};
  return design;
}

template <class Real>
void BasicEvaluator<Real>::evaluate(const Design& design, const Eigen::Ref<const Eigen::Matrix3Xd>& strains,
                                    Order order, Workspace& workspace, Evaluation& evaluation) const {
  auto& space = *workspace.content_;
  const auto run = [&](const Eigen::Ref<const Eigen::Matrix3Xd>& all, Evaluation& answer) {
    const long n = all.cols();
    EvaluationPass<Real> pass(*content_, *design.content_, order, n, space, answer);
    const long at_once = pass.strains_at_once();
    for (long begin = 0; begin < n; begin += at_once)
      pass.run(all.middleCols(begin, std::min(at_once, n - begin)), begin);
  };
  if (content_->images.empty()) {
    run(strains, evaluation);
    return;
  }
  content_->images.map_strains(strains, space.images);
  run(space.images, space.of_images);
  content_->images.average(space.of_images, strains.cols(), evaluation);
}

template <class Real>
Evaluation BasicEvaluator<Real>::evaluate(const Design& design, const Eigen::Ref<const Eigen::Matrix3Xd>& strains,
                                          Order order) const {
  Workspace workspace;
  Evaluation evaluation;
  evaluate(design, strains, order, workspace, evaluation);
  return evaluation;
}

template class BasicEvaluator<double>;
template class BasicEvaluator<float>;

}  // namespace supple::neural
