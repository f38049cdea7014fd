#include <pcl/point_types.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/transformation_estimation_2D.h>

#include <cmath>

#include "tests/bench/pair_matchers.hpp"

namespace odomcalib::bench {
namespace {

pcl::PointCloud<pcl::PointXYZ>::Ptr cloud_of(const Points& points) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (const Eigen::Vector2d& p : points)
    cloud->push_back(pcl::PointXYZ(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F));
  return cloud;
}

}  // namespace

Motion match_with_pcl(const Points& reference, const Points& scan) {
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  // Two dimensions: without it the plane z = 0 makes the general estimate singular.
  icp.setTransformationEstimation(
      pcl::make_shared<pcl::registration::TransformationEstimation2D<pcl::PointXYZ, pcl::PointXYZ>>());
  icp.setInputTarget(cloud_of(reference));
  icp.setInputSource(cloud_of(scan));
  icp.setMaxCorrespondenceDistance(kPeerReach);
  icp.setMaximumIterations(kPeerIterations);
  icp.setTransformationEpsilon(1e-10);
  pcl::PointCloud<pcl::PointXYZ> aligned;
  icp.align(aligned);
  if (!icp.hasConverged()) return std::nullopt;
  const Eigen::Matrix4f m = icp.getFinalTransformation();
  return std::array<double, 3>{m(0, 3), m(1, 3), std::atan2(m(1, 0), m(0, 0))};
}

}  // namespace odomcalib::bench
