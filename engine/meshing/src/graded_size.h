#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace supple::meshing {

/// Wanted lengths of edges in space: the minimum over all sources of (own length + grading * distance), at most
/// `max_length`. A k-d tree of the sources gives a value in O(log n), since only sources nearby matter.
class GradedSize {
 public:
  struct Source {
    Eigen::Vector3d position;
    double length;
  };

  GradedSize(std::vector<Source> sources, double max_length, double grading);

  double operator()(const Eigen::Vector3d& point) const;
  double max_length() const { return max_length_; }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    double min_length = 0;  ///< smallest length of a source in it
    std::int32_t first = 0;
    std::int32_t end = 0;
    std::int32_t children = 0;  ///< the first of two; 0 for a leaf
  };

  void divide(std::int32_t node);
  void search(const Node& node, const Eigen::Vector3d& point, double& min_length) const;
  double lower_bound(const Node& node, const Eigen::Vector3d& point) const;

  std::vector<Source> sources_;
  std::vector<Node> nodes_;
  double max_length_;
  double grading_;
};

}  // namespace supple::meshing
