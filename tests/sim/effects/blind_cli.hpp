// The options of a blind campaign on a command line, the same for all programs that draw one.
#pragma once

#include <CLI/CLI.hpp>
#include <set>
#include <string>

#include "tests/sim/effects/blind_case.hpp"
#include "tests/sim/effects/effect.hpp"

namespace odomcalib::sim {

inline void add_blind_options(CLI::App& app, BlindOptions& options) {
  app.add_option("--size-factor", options.size_factor, "scales every effect")->check(CLI::PositiveNumber);
  app.add_option("--without", options.share_without_effect, "share of recordings without effect")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--effects", options.effects, "effects in one recording");
  app.add_flag("--catalogue", options.only_catalogue, "only effects that the catalogue has");
  app.add_flag("--any-machine", options.any_machine,
               "other lidars, encoders and sizes than the usual robot's");
  app.add_flag("--few-speeds", options.few_speeds,
               "guided drives at a few speeds, with equal rests and pushes");
  app.add_flag("--tour", options.tour, "drives at work, forward only, instead of drives for calibration");
  app.add_flag("--free-laws", options.free_laws,
               "anything the robot does changes anything it moves by, by no mechanism");
  std::set<std::string> names;
  for (const EffectKind& kind : effect_kinds()) names.insert(kind.name);
  app.add_option("--only", options.only, "only these effects, for a closer look")
      ->check(CLI::IsMember(names));
}

}  // namespace odomcalib::sim
