// Pairs of simulated scans with exact truth, text files as described in data/scanmatch of the real data.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "proto/file_bytes.hpp"
#include "proto/measurements.hpp"

namespace odomcalib::test_support {

struct ScanPair {
  Scan reference, scan;
  std::array<double, 3> truth{};                              ///< scan in the frame of reference
  std::array<double, 3> guess{};                              ///< start of the search
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();  ///< no estimator knows the truth better

  /// Square root of the trace of the least possible covariance of the translation, m.
  [[nodiscard]] double translation_bound() const {
    return std::sqrt(information.inverse().topLeftCorner<2, 2>().trace());
  }
};

namespace internal {

inline void read_header(std::istream& in, ScanPair& pair) {
  int id = 0;
  std::size_t beams = 0;
  for (Scan* scan : {&pair.reference, &pair.scan}) scan->ranges.clear();
  Scan& a = pair.reference;
  in >> id >> beams >> a.angle_min >> a.angle_increment >> a.range_max;
  a.ranges.resize(beams);
  pair.scan = a;
}

inline void read_information(std::istream& in, Eigen::Matrix3d& m) {
  in >> m(0, 0) >> m(0, 1) >> m(0, 2) >> m(1, 1) >> m(1, 2) >> m(2, 2);
  m(1, 0) = m(0, 1);
  m(2, 0) = m(0, 2);
  m(2, 1) = m(1, 2);
}

}  // namespace internal

/// All pairs of a set, plain or gzip; empty when the file cannot be read.
inline std::vector<ScanPair> read_scan_pairs(const std::filesystem::path& path) {
  std::vector<ScanPair> pairs;
  auto bytes = read_file_bytes(path);
  if (!bytes) return pairs;
  std::istringstream in(is_gzip(bytes.value()) ? gunzip(bytes.value()).bytes : bytes.value());
  for (std::string line; std::getline(in, line);) {
    std::istringstream fields(line);
    std::string tag;
    fields >> tag;
    if (tag == "PAIR") internal::read_header(fields, pairs.emplace_back());
    if (pairs.empty()) continue;
    ScanPair& pair = pairs.back();
    if (tag == "TRUTH")
      for (double& value : pair.truth) fields >> value;
    if (tag == "GUESS")
      for (double& value : pair.guess) fields >> value;
    if (tag == "IPAIR") internal::read_information(fields, pair.information);
    if (tag == "REF")
      for (float& range : pair.reference.ranges) fields >> range;
    if (tag == "SENS")
      for (float& range : pair.scan.ranges) fields >> range;
  }
  return pairs;
}

}  // namespace odomcalib::test_support
