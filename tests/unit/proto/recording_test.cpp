#include "proto/recording.hpp"

#include <gtest/gtest.h>

namespace odomcalib {
namespace {

TEST(Recording, reports_a_file_that_cannot_be_opened) {
  const auto result = read_recording("/nonexistent/recording.jsonl");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::io);
}

}  // namespace
}  // namespace odomcalib
