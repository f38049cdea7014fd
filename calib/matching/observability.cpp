#include "calib/matching/observability.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace odomcalib::calib::matching {

Observability observability(const Eigen::Matrix3d& information) {
  if (!(information(2, 2) > 0.0)) return {};
  const Eigen::Matrix2d schur = information.topLeftCorner<2, 2>() - information.topRightCorner<2, 1>() *
                                                                        information.bottomLeftCorner<1, 2>() /
                                                                        information(2, 2);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(schur);
  return {std::max(eigen.eigenvalues()(0), 0.0) / std::max(eigen.eigenvalues()(1), 1e-300),
          eigen.eigenvectors().col(0)};
}

}  // namespace odomcalib::calib::matching
