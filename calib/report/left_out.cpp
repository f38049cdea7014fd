#include "calib/report/left_out.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "calib/report/one_sided.hpp"
#include "proto/recording/left_out.hpp"

namespace odomcalib::calib::report {
namespace {

/// The name says which of several recordings is meant.
std::string reason_in(std::span<const Recording> recordings, std::size_t k, const std::string& reason) {
  return recordings.size() > 1 ? recordings[k].name + ": " + reason : reason;
}

/// Whether the values of this recording stand on samples of this name.
bool is_used(const Recording& recording, const std::string& what) {
  if (what == "scan") return recording.poses.empty();
  if (what == "pose") return true;
  return what == kInterval || what == "ticks" || what == name_of(recording.motion);
}

void add_losses(std::span<const Recording> recordings, std::size_t k, std::vector<Loss>& losses) {
  struct Stream {
    double share = 0.0;
    const Discarded* most = nullptr;
  };
  const Recording& recording = recordings[k];
  const std::vector<Discarded> all = left_out_of(recording);
  std::map<std::string, Stream> streams;
  for (const Discarded& one : all) {
    if (!is_loss(one) || one.of == 0 || !is_used(recording, one.what)) continue;
    Stream& stream = streams[is_loss_of_motion(one) ? kInterval : one.what];
    stream.share += share_of(one);
    if (stream.most == nullptr || one.count > stream.most->count) stream.most = &one;
  }
  const auto start = recording.ticks.empty() ? std::nullopt : std::optional(recording.ticks.front().t);
  for (const auto& [name, stream] : streams) {
    Discarded most = *stream.most;
    most.reason = reason_in(recordings, k, most.reason);
    losses.push_back({stream.share, to_text(most, start), is_loss_of_motion(most)});
  }
  for (Discarded one : one_sided(recording)) {
    const double share = share_of(one);
    one.reason = reason_in(recordings, k, one.reason);
    losses.push_back({share, to_text(one, start)});
  }
}

std::string milliseconds(double seconds) { return std::to_string(std::lround(1e3 * seconds)) + " ms"; }

Repair repair_of(ingest::SweepKind kind) {
  Repair repair{"times of the beams", "a head that turns once from scan to scan", ""};
  switch (kind) {
    case ingest::SweepKind::assumed:
      repair.reason = "scans do not say when their beams were sent, and this explains the motion better";
      break;
    case ingest::SweepKind::instead_of_stated:
      repair.reason = "the times that scans state explain the motion worse";
      break;
    case ingest::SweepKind::against_the_list:
      repair.what = "order of the beams";
      repair.chosen = "against that of the list";
      repair.reason = "a head that turns the other way explains the motion better";
  }
  return repair;
}

}  // namespace

std::vector<Discarded> left_out(std::span<const Recording> recordings,
                                std::span<const measurement::PairSet> pairs) {
  std::vector<Discarded> all;
  const auto add = [&](std::size_t k, Discarded one) {
    one.reason = reason_in(recordings, k, one.reason);
    all.push_back(std::move(one));
  };
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    for (const Discarded& one : left_out_of(recordings[k])) add(k, one);
    for (const Discarded& one : one_sided(recordings[k])) add(k, one);
    if (k >= pairs.size()) continue;
    std::size_t of = pairs[k].pairs.size();
    for (const auto& [reason, count] : pairs[k].rejected) of += count;
    for (const auto& [reason, count] : pairs[k].rejected)
      add(k, {.what = "pair", .reason = reason, .count = count, .of = of});
  }
  return all;
}

std::vector<Discarded> outlier_pairs(const measurement::Dataset& dataset, const estimation::FitResult& fit) {
  std::size_t pairs = 0;
  for (const measurement::FitData& data : dataset.data) pairs += data.pairs.size();
  if (fit.outlier.size() != pairs || fit.discarded == 0) return {};
  const std::span<const Recording> recordings = dataset.recordings.view();
  std::vector<Discarded> all;
  std::size_t next = 0;
  for (std::size_t k = 0; k < dataset.data.size(); ++k) {
    Discarded one{.what = "pair",
                  .reason = reason_in(recordings, k, "contradicts all others by more than five deviations"),
                  .of = dataset.data[k].pairs.size()};
    for (const measurement::SensorPair& pair : dataset.data[k].pairs) {
      if (!fit.outlier[next++]) continue;
      ++one.count;
      for (const double t : {pair.interval.begin, pair.interval.end}) include(one, t);
    }
    if (one.count > 0) all.push_back(std::move(one));
  }
  return all;
}

std::vector<Repair> repairs_of(const ingest::Recordings& recordings) {
  std::vector<Repair> all;
  for (std::size_t k = 0; k < recordings.size(); ++k)
    for (const Repair& one : recordings[k].repairs)
      all.push_back({one.what, one.chosen, reason_in(recordings.view(), k, one.reason)});
  const ingest::StampReport& stamps = recordings.stamps();
  const auto add_even = [&](const char* what, double jitter) {
    if (jitter > 0.0)
      all.push_back({what, "even times",
                     "stamps jitter by " + milliseconds(jitter) +
                         " although the motion shows that samples were taken evenly"});
  };
  add_even("stamps of the counts", stamps.ticks);
  add_even("stamps of the scans", stamps.scans);
  if (stamps.sweep > 0.0) all.push_back(repair_of(stamps.kind));
  if (stamps.clocks > 0.0)
    all.push_back({"clocks", "one for each recording",
                   "they differ by " + milliseconds(stamps.clocks) + " (standard deviation) beyond chance"});
  return all;
}

std::vector<Loss> losses_of(std::span<const Recording> recordings) {
  std::vector<Loss> losses;
  for (std::size_t k = 0; k < recordings.size(); ++k) add_losses(recordings, k, losses);
  return losses;
}

}  // namespace odomcalib::calib::report
