#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <mrpt/slam/CICP.h>

#include "tests/bench/pair_matchers.hpp"

namespace odomcalib::bench {
namespace {

mrpt::maps::CSimplePointsMap map_of(const Points& points) {
  mrpt::maps::CSimplePointsMap map;
  for (const Eigen::Vector2d& p : points)
    map.insertPoint(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F);
  return map;
}

}  // namespace

Motion match_with_mrpt(const Points& reference, const Points& scan) {
  const auto target = map_of(reference), source = map_of(scan);
  mrpt::slam::CICP icp;
  icp.options.ICP_algorithm = mrpt::slam::icpClassic;
  icp.options.maxIterations = kPeerIterations;
  icp.options.thresholdDist = kPeerReach;
  mrpt::slam::CICP::TReturnInfo info;
  const auto pdf = icp.Align(&target, &source, mrpt::poses::CPose2D(0.0, 0.0, 0.0), info);
  if (!pdf) return std::nullopt;
  const auto mean = pdf->getMeanVal();
  return std::array<double, 3>{mean.x(), mean.y(), mean.phi()};
}

}  // namespace odomcalib::bench
