// The rules of the verdict: one table, one function per rule. Each reads figures of the calibration that the
// report prints too, and says what it objects to.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "calib/report/gate.hpp"

namespace odomcalib::calib::report {

struct Objection {
  bool refuses = false;
  std::string reason;  ///< a sentence: what was found, and what to do about it
};

struct VerdictRule {
  const char* name;
  std::vector<Objection> (*objections)(const Calibration& calibration, const Footing& footing);
};

/// ", with 17 of 361 readings a scan" where so many beams met nothing that it matters; else nothing.
std::string few_readings(std::size_t readings, std::size_t beams);

/// ", and in 12 the wheels turned and the robot stood ..."; nothing where there are none.
std::string while_it_stood(std::size_t pairs);

/// In the order in which reasons are listed.
std::span<const VerdictRule> verdict_rules();

}  // namespace odomcalib::calib::report
