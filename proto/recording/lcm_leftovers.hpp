// LCM messages that a recording does not use: counted, never a reason to fail. Internal to proto/.
#pragma once

#include <cstdint>
#include <vector>

#include "proto/recording/recording_builder.hpp"

namespace odomcalib {

/// Names those that are known; lists the others by fingerprint, a limited number of them.
class LcmLeftovers {
 public:
  explicit LcmLeftovers(RecordingBuilder& builder) : builder_(builder) {}
  void add(std::uint64_t fingerprint);

 private:
  RecordingBuilder& builder_;
  std::vector<std::uint64_t> seen_;
};

}  // namespace odomcalib
