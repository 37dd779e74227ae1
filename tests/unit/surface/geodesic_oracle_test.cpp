// Distances against CGAL's exact geodesics, on every generated shape.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>

#include "supple/surface/exponential_map.h"
#include "supple/surface/geodesic_solver.h"
#include "support/cgal_geodesics.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using supple::testing::CgalGeodesics;
using supple::testing::SurfaceSampler;

/// Both sides compute in double precision by different constructions.
constexpr double max_difference = 1e-9;
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Shape {
  std::string name;
  std::function<TriangleMesh()> make;
};
void PrintTo(const Shape& shape, std::ostream* out) { *out << shape.name; }

std::vector<Shape> shapes() {
  using namespace supple::testing;
  return {
      {"sphere", [] { return icosphere(3); }},
      {"torus", [] { return torus(); }},
      {"genus3", [] { return genus3(); }},
      {"saddle", [] { return saddle(24); }},
      {"cube", [] { return cube(6); }},
      {"bumpy_cube", [] { return bumpy_cube(14, 3.5, 0.02); }},
      {"steep_bumpy_cube", [] { return bumpy_cube(18, 4, 0.06); }},
      {"spiral_cup", [] { return spiral_cup(140, 10); }},
      {"trefoil_knot", [] { return trefoil_knot(100, 10); }},
      {"open_hemisphere", [] { return open_hemisphere(); }},
      {"slit_annulus", [] { return slit_annulus(); }},
      {"l_shape", [] { return l_shape(8); }},
      {"flat_grid", [] { return flat_grid(16, 16); }},
      {"jittered_grid",
       [] {
         RandomStream stream("jitter", 1);
         return jittered_grid(16, 16, stream);
       }},
      {"sharp_cone", [] { return cone(12, 3.0, 4); }},
      {"saddle_cone", [] { return cone(12, 9.0, 4); }},
      {"needle_cylinder", [] { return needle_cylinder(); }},
      {"sliver_sphere", [] { return sliver_sphere(); }},
      {"two_components", [] { return two_components(); }},
  };
}

std::string describe(const SurfacePoint& p) {
  std::ostringstream text;
  text.precision(17);
  text << "face " << index(p.face) << " (" << p.barycentric.transpose() << ")";
  return text.str();
}

/// Counts comparisons and reports the worst, so that a systematic fault gives one message and not thousands.
class Agreement {
 public:
  /// `what` is asked for its text only where the comparison is the worst so far.
  void compare(double ours, double exact, const std::function<std::string()>& what) {
    ++count_;
    double error = 0;
    if (ours == infinity || exact == infinity)
      error = ours == exact ? 0 : infinity;
    else
      error = std::abs(ours - exact) / std::max(exact, std::numeric_limits<double>::min());
    if (!(error <= worst_)) {
      worst_ = error;
      worst_text_ = what() + ": " + ::testing::PrintToString(ours) + " against " + ::testing::PrintToString(exact);
    }
  }
  void expect_within(double tolerance, int least_count) const {
    EXPECT_LE(worst_, tolerance) << worst_text_;
    EXPECT_GE(count_, least_count);
  }

 private:
  int count_ = 0;
  double worst_ = 0;
  std::string worst_text_;
};

class GeodesicOracle : public ::testing::TestWithParam<Shape> {
 protected:
  GeodesicOracle()
      : mesh_(std::make_shared<const TriangleMesh>(GetParam().make())),
        solver_(mesh_),
        cgal_(*mesh_),
        sampler_(*mesh_),
        stream_("geodesic oracle", 11) {}

  SurfacePoint interior() { return sampler_.point(stream_); }
  /// A point within three edge lengths of another, by walking straight ahead.
  SurfacePoint near(const SurfacePoint& point) {
    const double angle = stream_.uniform(0, 6.28);
    const double length = stream_.uniform(0.01, 3) * mesh_->mean_edge_length();
    const Eigen::Vector3d tangent =
        tangent_frame(*mesh_, point.face) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    return exponential_map(*mesh_, point, length * tangent, {}, false).end;
  }

  GeodesicField kept_field(const SurfacePoint& source) const {
    FieldOptions options;
    options.keep_windows = true;
    return solver_.field({&source, 1}, options);
  }

  void search_by_cgal(const SurfacePoint& source) {
    cgal_.set_source(source);
    cgal_.search();
  }

  /// Field and pair searches from `source` against the oracle, at vertices and in faces, far and near.
  void compare_all_from(const SurfacePoint& source, Agreement& agreement) {
    search_by_cgal(source);
    const GeodesicField field = kept_field(source);
    const std::vector<double> exact = cgal_.vertex_distances();
    for (std::int32_t v = 0; v < mesh_->vertex_count(); ++v) {
      agreement.compare(field.vertex_distances()[v], exact[v],
                        [&] { return "vertex " + std::to_string(v) + " from " + describe(source); });
    }
    for (int i = 0; i < 500; ++i) {
      const SurfacePoint target = i % 5 == 4 ? near(source) : interior();
      const double expected = cgal_.distance(target);
      agreement.compare(field.distance(target), expected,
                        [&] { return "field at " + describe(target) + " from " + describe(source); });
      if (i % 3 != 0) continue;
      agreement.compare(solver_.distance(source, target), expected,
                        [&] { return "pair " + describe(source) + " to " + describe(target); });
    }
    for (int i = 0; i < 40; ++i) {
      const SurfacePoint target = i % 2 == 0 ? supple::testing::random_vertex_point(*mesh_, stream_)
                                             : supple::testing::random_edge_point(*mesh_, stream_);
      const double expected = cgal_.distance(target);
      agreement.compare(field.distance(target), expected,
                        [&] { return "field at " + describe(target) + " from " + describe(source); });
      agreement.compare(solver_.distance(source, target), expected,
                        [&] { return "pair " + describe(source) + " to " + describe(target); });
    }
  }

  std::shared_ptr<const TriangleMesh> mesh_;
  GeodesicSolver solver_;
  CgalGeodesics cgal_;
  SurfaceSampler sampler_;
  RandomStream stream_;
};

TEST_P(GeodesicOracle, DistancesFromPointsInsideFacesAgree) {
  Agreement agreement;
  for (int i = 0; i < 6; ++i) compare_all_from(interior(), agreement);
  agreement.expect_within(max_difference, 4000);
}

TEST_P(GeodesicOracle, DistancesFromVerticesAgree) {
  Agreement agreement;
  for (int i = 0; i < 4; ++i) compare_all_from(supple::testing::random_vertex_point(*mesh_, stream_), agreement);
  agreement.expect_within(max_difference, 2500);
}

TEST_P(GeodesicOracle, DistancesFromPointsOnEdgesAgreeWithTheOtherEnd) {
  std::vector<SurfacePoint> sources;
  std::vector<GeodesicField> fields;
  for (int i = 0; i < 60; ++i) {
    sources.push_back(supple::testing::random_edge_point(*mesh_, stream_));
    fields.push_back(kept_field(sources.back()));
  }
  Agreement agreement;
  for (int i = 0; i < 4; ++i) {
    const SurfacePoint target = interior();
    search_by_cgal(target);
    for (std::size_t k = 0; k < sources.size(); ++k) {
      const double expected = cgal_.distance(sources[k]);
      agreement.compare(fields[k].distance(target), expected,
                        [&] { return "field at " + describe(target) + " from " + describe(sources[k]); });
      agreement.compare(solver_.distance(sources[k], target), expected,
                        [&] { return "pair " + describe(sources[k]) + " to " + describe(target); });
    }
  }
  agreement.expect_within(max_difference, 400);
}

TEST_P(GeodesicOracle, OneSearchForManyTargetsGivesTheDistancesOfPairs) {
  Agreement agreement;
  for (int i = 0; i < 4; ++i) {
    const SurfacePoint source = interior();
    search_by_cgal(source);
    std::vector<SurfacePoint> targets;
    for (int k = 0; k < 60; ++k) {
      targets.push_back(k % 3 == 0   ? near(source)
                        : k % 3 == 1 ? interior()
                                     : supple::testing::random_vertex_point(*mesh_, stream_));
    }
    const std::vector<Geodesic> together = solver_.geodesics(source, targets);
    ASSERT_EQ(together.size(), targets.size());
    for (std::size_t k = 0; k < targets.size(); ++k) {
      const auto what = [&] { return describe(source) + " to " + describe(targets[k]); };
      agreement.compare(together[k].distance, cgal_.distance(targets[k]), what);
      agreement.compare(together[k].distance, solver_.distance(source, targets[k]), what);
      EXPECT_EQ(together[k].unreachable, together[k].distance == infinity);
    }
  }
  agreement.expect_within(max_difference, 480);
}

TEST_P(GeodesicOracle, FieldsStopAtTheirLargestDistance) {
  const SurfacePoint source = interior();
  search_by_cgal(source);
  const std::vector<double> exact = cgal_.vertex_distances();
  std::vector<double> sorted = exact;
  std::sort(sorted.begin(), sorted.end());
  FieldOptions options;
  // Half way between two vertices' distances, so that rounding does not decide.
  const std::size_t middle = sorted.size() / 4;
  options.max_distance = 0.5 * (sorted[middle] + sorted[middle + 1]);
  if (!(sorted[middle + 1] > sorted[middle] * (1 + max_difference))) GTEST_SKIP() << "two vertices at the limit";
  const std::vector<double> found = solver_.field({&source, 1}, options).vertex_distances();
  Agreement agreement;
  for (std::int32_t v = 0; v < mesh_->vertex_count(); ++v) {
    agreement.compare(found[v], exact[v] <= options.max_distance ? exact[v] : infinity,
                      [&] { return "vertex " + std::to_string(v) + " from " + describe(source); });
  }
  agreement.expect_within(max_difference, mesh_->vertex_count());
}

TEST_P(GeodesicOracle, ErrorBoundedFieldsKeepTheirBound) {
  constexpr double rounding = 1e-12;
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 300; ++i) points.push_back(interior());
  for (int i = 0; i < 6; ++i) {
    const SurfacePoint source = i % 3 == 2 ? supple::testing::random_vertex_point(*mesh_, stream_) : interior();
    const GeodesicField exact = kept_field(source);
    for (const double error : {1e-3, 1e-2, 0.1}) {
      FieldOptions options;
      options.relative_error = error;
      options.keep_windows = true;
      const GeodesicField bounded = solver_.field({&source, 1}, options);
      EXPECT_EQ(bounded.relative_error_bound(), error);
      // Relative to the bound: at most 1. Counted with what lies below the exact distance, which nothing may.
      double most = 0;
      std::string where = "nowhere";
      const auto check = [&](double d, double least, const std::string& place) {
        if (least == infinity) {
          EXPECT_EQ(d, infinity) << place;
          return;
        }
        EXPECT_GE(d, least * (1 - rounding)) << place << " from " << describe(source);
        if (least > 0 && d / least - 1 > most) {
          most = d / least - 1;
          where = place;
        }
      };
      for (std::int32_t v = 0; v < mesh_->vertex_count(); ++v) {
        check(bounded.vertex_distances()[v], exact.vertex_distances()[v], "vertex " + std::to_string(v));
      }
      for (const SurfacePoint& p : points) check(bounded.distance(p), exact.distance(p), describe(p));
      EXPECT_LE(most, error * (1 + 1e-9) + rounding) << where << " from " << describe(source);
    }
  }
}

TEST_P(GeodesicOracle, EdgePathsAreNeverShorterThanGeodesics) {
  for (int i = 0; i < 4; ++i) {
    const SurfacePoint source = interior();
    search_by_cgal(source);
    const std::vector<double> exact = cgal_.vertex_distances();
    FieldOptions options;
    options.method = FieldMethod::edge_graph;
    const GeodesicField field = solver_.field({&source, 1}, options);
    EXPECT_TRUE(std::isnan(field.relative_error_bound()));
    for (std::int32_t v = 0; v < mesh_->vertex_count(); ++v) {
      EXPECT_GE(field.vertex_distances()[v], exact[v] * (1 - max_difference))
          << "vertex " << v << " from " << describe(source);
      EXPECT_EQ(field.vertex_distances()[v] == infinity, exact[v] == infinity) << "vertex " << v;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(On, GeodesicOracle, ::testing::ValuesIn(shapes()),
                         [](const auto& shape) { return shape.param.name; });

}  // namespace
}  // namespace supple::surface
