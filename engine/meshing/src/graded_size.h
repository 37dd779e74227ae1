#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace supple::meshing {

/// Wanted lengths of edges in space: the least over all sources of (own length + grading * distance), and no more than
/// `largest`. A k-d tree over the sources: O(log n) for a value, since only sources nearby decide it.
class GradedSize {
 public:
  struct Source {
    Eigen::Vector3d at;
    double length;
  };

  GradedSize(std::vector<Source> sources, double largest, double grading);

  double operator()(const Eigen::Vector3d& point) const;
  double largest() const { return largest_; }

 private:
  struct Branch {
    Eigen::AlignedBox3d box;
    double least = 0;  ///< length of a source in it
    std::int32_t first = 0;
    std::int32_t end = 0;
    std::int32_t children = 0;  ///< the first of two; 0 for a leaf
  };

  void divide(std::int32_t branch);
  void search(const Branch& branch, const Eigen::Vector3d& point, double& least) const;
  double bound(const Branch& branch, const Eigen::Vector3d& point) const;

  std::vector<Source> sources_;
  std::vector<Branch> branches_;
  double largest_;
  double grading_;
};

}  // namespace supple::meshing
