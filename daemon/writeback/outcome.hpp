// How a write-back can end, and what each end means for everything else: decided in this table alone.
#pragma once

#include <span>
#include <string>

#include "daemon/writeback/drive_proof.hpp"

namespace odomcalib {

enum class WriteOutcome {
  read,         ///< only read
  proving,      ///< new values in force and not stored: they wait for their proof
  committed,    ///< new values in force and stored
  rolled_back,  ///< old values in force
  unknown,      ///< forbids motion until an operator or a recovery has decided
};

struct Ending {
  WriteOutcome outcome;
  const char* name;  ///< in the history, in events and in replies
  bool of_a_write;   ///< false: nothing was to be written, and nobody waits for an answer
  bool as_asked;     ///< the values that were asked for are in force; else whoever asked gets the error
  bool certain;      ///< it is known what the controller holds; else nothing may move
  bool lasts;        ///< the history gets an entry, and the calibration in force is decided
  void (DriveProof::*proof)();  ///< what becomes of what was driven; null: nothing
};

/// All of them.
std::span<const Ending> endings();
const Ending& ending_of(WriteOutcome outcome);
std::string name_of(WriteOutcome outcome);

}  // namespace odomcalib
