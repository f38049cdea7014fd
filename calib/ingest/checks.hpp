// Possible faults of a recording, by the form of its data: one table. A row is a fault, a column a form, and
// each cell says who reports or mends it, or why that form cannot have it.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "calib/ingest/form.hpp"

namespace odomcalib::calib::ingest {

using Check = std::optional<Error> (*)(const Recording&);

/// Treatment of a fault.
enum class Answer {
  told,      ///< refused by its name before anything is measured
  mended,    ///< put right, and said so
  counted,   ///< left out and listed; the verdict weighs how much
  measured,  ///< told by its name once the reference has shown how the robot moved
  cannot     ///< that form cannot have it
};

struct Cell {
  Answer answer;
  const char* words;      ///< of a mended one how, of one that cannot be why; empty where the name says it
  Check check = nullptr;  ///< of those that are told
};

struct Fault {
  const char* name;                ///< e.g. "lost_digits"
  const char* words;               ///< e.g. "stamps without their last digits"
  std::array<Cell, kForms> cells;  ///< by Form
};

std::span<const Fault> faults();

/// "told", "mended", ...
const char* name_of(Answer answer);

/// The table as Markdown, for docs/user/formats.md.
std::string faults_table();

/// The first fault that is told of this recording. Error: format.
std::optional<Error> told_fault(const Recording& recording);

}  // namespace odomcalib::calib::ingest
