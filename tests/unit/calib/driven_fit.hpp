// Datasets and fits of driven recordings.
#pragma once

#include <gtest/gtest.h>

#include <span>
#include <utility>

#include "calib/estimation/fit.hpp"
#include "calib/stages/fit_stages.hpp"
#include "tests/unit/calib/driven_recording.hpp"

namespace odomcalib::test_support {

inline calib::measurement::Dataset rough_dataset(std::span<const Recording> recordings) {
  auto opened = calib::measurement::open_dataset(calib::ingest::Recordings(recordings));
  EXPECT_TRUE(opened.ok());
  return measured_roughly(std::move(opened).value());
}

inline calib::estimation::Settling silent_settling() {
  return calib::stages::settling(true, [](const std::string&, double) {});
}

inline calib::estimation::Fit settled_fit(std::span<const Recording> recordings) {
  calib::terms::Request request;
  request.is_automatic = true;
  return fit_anew(rough_dataset(recordings), request, silent_settling());
}

}  // namespace odomcalib::test_support
