#include "limit_multipliers.h"

#include <gtest/gtest.h>

#include "layouts.h"
#include "supple/numerics/derivative_check.h"
#include "weave_system.h"

namespace supple::weave {
namespace {

/// The weave `wavy` of layouts.h, whose sliders may move 1.5 mm backward and 1.2 mm forward.
class RigidLimits : public ::testing::Test {
 protected:
  Weave weave_ = wavy();
  RodModel model_{weave_, {}, {.spatial = false, .segments = 1}};
  std::vector<bool> held_ = gauge_constraints(model_);

  WeaveSystem at(double first_slider) const {
    Eigen::VectorXd q = model_.rest_state();
    q[model_.slider(0)] = first_slider;
    return {model_, q, {}, held_, {.barrier_range = 0.1}};
  }
};

TEST_F(RigidLimits, CloseWhereBarriersPushAndHaveExactDerivatives) {
  const WeaveSystem barriers = at(1.15);
  WeaveSystem rigid = barriers.with_rigid_limits();
  ASSERT_NE(rigid.multipliers(), nullptr);
  EXPECT_EQ(rigid.q(), barriers.q());
  EXPECT_TRUE(rigid.multipliers()->all_inactive());
  const double open = rigid.evaluate(0).value;
  EXPECT_EQ(rigid.stored_energy(), open);
  rigid.multipliers()->initialize(rigid.q());
  rigid.forget();
  EXPECT_FALSE(rigid.multipliers()->all_inactive());
  EXPECT_GT(rigid.evaluate(0).value, open);
  EXPECT_NEAR(rigid.stored_energy(), open, 1e-9 * rigid.evaluate(0).value) << "what limits add is no stored energy";
  EXPECT_GT(rigid.multipliers()->error(rigid.q()), 0);
  const auto check = numerics::check_derivatives(rigid, {.step = 1e-3});
  EXPECT_LT(check.gradient.error, 1e-7) << check.summary();
  EXPECT_LT(check.hessian.error, 1e-6) << check.summary();
}

TEST_F(RigidLimits, OpenWhereTheyPullAndCloseWhereTheyAreCrossed) {
  const WeaveSystem barriers = at(1.15);
  WeaveSystem rigid = barriers.with_rigid_limits();
  LimitMultipliers& limits = *rigid.multipliers();
  limits.initialize(rigid.q());
  // Half a millimetre before the limit, the constraint force would have to be tensile.
  Eigen::VectorXd q = rigid.q();
  q[model_.slider(0)] = 0.7;
  EXPECT_TRUE(limits.update(q));
  EXPECT_TRUE(limits.all_inactive());
  EXPECT_FALSE(limits.update(q));
  q[model_.slider(0)] = 1.21;
  EXPECT_TRUE(limits.update(q));
  EXPECT_FALSE(limits.all_inactive());
}

}  // namespace
}  // namespace supple::weave
