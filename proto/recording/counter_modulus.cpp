#include "proto/recording/counter_modulus.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

namespace odomcalib {
namespace {

// Share of the span of the counts: a larger step from one sample to the next is a wrap, or a reset. Derived:
// half of what a counter can hold.
constexpr double kWrap = 0.5;
// Wraps that show at which number. Chosen: a single one may be a reset.
constexpr std::size_t kFewestWraps = 3;
// The same of a number that no encoder has. Chosen: three agree by chance to the count in one recording of a
// thousand, five in none of ten thousand.
constexpr std::size_t kFewestUnusual = 5;
// Share of the number by which a wrap may miss it, of one sample's motion. Chosen.
constexpr double kMiss = 0.1;
// The same where the span of the counts tells the number: wheels that are sampled coarsely change their speed
// by more from step to step. Chosen: half of what would leave two answers.
constexpr double kCoarseMiss = 0.25;
// Share of the jumps that may have another jump beside them, or not go against the motion about them, before
// they are taken for the turns of two programs that write, for resets or for motion. Chosen.
constexpr double kMostUnlike = 0.3;
// Share of the steps that may be out of line with the one before. Chosen: single counts are misread.
constexpr double kMostOutOfLine = 0.005;
// Steps in motion before the span of the counts tells how far they reach. Chosen.
constexpr std::size_t kFewestSteps = 100;
// Times the mean distance of that many counts, spread over the number, that the highest and the lowest may
// be from its ends together. Derived: a larger distance has a probability of 0.7 % (exp(-5)) at each end.
constexpr double kGaps = 5.0;
// Counts by which the mean of all wraps may lie above a usual number and below it, besides three standard
// errors: a step that holds a wrap is longer than those beside it, by a count where wheels are slow.
constexpr double kAbove = 0.5, kBelow = 1.5, kMeanErrors = 3.0;
// Counters of 16 and 32 bits, and the share of these by which jumps may miss them. Chosen: 60000 is none.
constexpr std::array<double, 2> kWidths = {65536.0, 4294967296.0};
constexpr double kWidthMiss = 0.03;
// Counts of any other number: below it, an error of one count matters (0.02 %).
constexpr double kLeastUnusual = 5000.0;
// Counts of usual encoders and controllers: bits, lines and four times as many, degrees, decimal digits.
constexpr std::array<std::int64_t, 31> kUsual = {
    200,  256,  360,  400,  500,  512,  600,  720,  800,   1000,  1024,  1440,  1600,  2000,  2048,  2400,
    2500, 3600, 4000, 4096, 5000, 8000, 8192, 9000, 10000, 16384, 20000, 32768, 36000, 40000, 100000};

struct Counter {
  std::vector<double> counts;
  std::vector<double> steps;  ///< to each count from the one before; 0 for the first
  double low = 0.0, high = 0.0;
  [[nodiscard]] double span() const { return high - low; }
};

/// Exact for counts below 2^53, which is all that a recording has.
Counter counter_of(const std::vector<TickSample>& ticks, std::int64_t TickSample::*side) {
  Counter counter;
  for (const TickSample& tick : ticks) {
    counter.counts.push_back(static_cast<double>(tick.*side));
    const bool follows =
        counter.counts.size() > 1 && ticks[counter.counts.size() - 2].segment == tick.segment;
    counter.steps.push_back(follows ? counter.counts.back() - counter.counts[counter.counts.size() - 2]
                                    : 0.0);
  }
  const auto [low, high] = std::minmax_element(counter.counts.begin(), counter.counts.end());
  counter.low = *low;
  counter.high = *high;
  return counter;
}

struct Wraps {
  std::vector<double> moduli;  ///< what each wrap says
  std::size_t doubled = 0;     ///< jumps with another jump beside them
  std::size_t unlike = 0;      ///< wraps that do not go against the motion about them, as wraps do
  double low = 0.0, high = 0.0;
};

/// @param span of the counts that a jump is measured by
Wraps wraps_of(const Counter& counter, double span) {
  Wraps wraps;
  wraps.low = counter.low;
  wraps.high = counter.high;
  const double limit = kWrap * span;
  for (std::size_t k = 2; k + 1 < counter.steps.size(); ++k) {
    const double jump = counter.steps[k];
    if (std::abs(jump) <= limit) continue;
    const double before = counter.steps[k - 1], after = counter.steps[k + 1];
    if (std::abs(before) > limit || std::abs(after) > limit) {
      ++wraps.doubled;
      continue;
    }
    if (!((before + after) * jump < 0.0)) ++wraps.unlike;
    // Where a count that grows wraps, the jump is the motion less the number.
    wraps.moduli.push_back(std::abs(0.5 * (before + after) - jump));
  }
  return wraps;
}

Wraps joined(Wraps a, const Wraps& b) {
  a.moduli.insert(a.moduli.end(), b.moduli.begin(), b.moduli.end());
  a.doubled += b.doubled;
  a.unlike += b.unlike;
  a.low = std::min(a.low, b.low);
  a.high = std::max(a.high, b.high);
  return a;
}

struct Mean {
  double value = 0.0, error = 0.0;  ///< counts
};

Mean mean_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value;
  const double mean = sum / n;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, std::sqrt(squares / (n - 1.0) / n)};
}

bool holds(double low, double high, double modulus) {
  const double least = low >= 0.0 ? 0.0 : -0.5 * modulus;
  return low >= least && high < least + modulus;
}

/// About the number on which the jumps agree, where they stand apart from each other and go against the
/// motion about them.
std::optional<double> number_of_wraps(const Wraps& wraps) {
  const auto most = [&](std::size_t of) { return kMostUnlike * static_cast<double>(of); };
  if (wraps.moduli.size() < kFewestWraps || static_cast<double>(wraps.unlike) > most(wraps.moduli.size()) ||
      static_cast<double>(wraps.doubled) > most(wraps.moduli.size() + wraps.doubled))
    return std::nullopt;
  std::vector<double> moduli = wraps.moduli;
  const auto middle = moduli.begin() + static_cast<std::ptrdiff_t>(moduli.size() / 2);
  std::nth_element(moduli.begin(), middle, moduli.end());
  const double number = *middle;
  const auto unlike = std::count_if(moduli.begin(), moduli.end(), [&](double one) {
    return std::abs(one - number) > kCoarseMiss * number;
  });
  if (static_cast<double>(unlike) > most(moduli.size())) return std::nullopt;
  return number;
}

/// The number that the jumps themselves tell to the count: those of wheels that move little from sample to
/// sample.
std::int64_t told_by_jumps(const Wraps& wraps) {
  if (wraps.moduli.size() < kFewestWraps) return 0;
  const Mean mean = mean_of(wraps.moduli);
  if (std::any_of(wraps.moduli.begin(), wraps.moduli.end(),
                  [&](double one) { return std::abs(one - mean.value) > kMiss * mean.value; }))
    return 0;
  const double spread = kMeanErrors * mean.error;
  const auto is_near = [&](double number) {
    return mean.value - number <= kAbove + spread && number - mean.value <= kBelow + spread &&
           holds(wraps.low, wraps.high, number);
  };
  for (const std::int64_t usual : kUsual)
    if (is_near(static_cast<double>(usual))) return usual;
  if (wraps.moduli.size() < kFewestUnusual || !number_of_wraps(wraps) ||
      std::any_of(kWidths.begin(), kWidths.end(), is_near))
    return 0;
  const double nearest = std::max(std::round(mean.value), wraps.low >= 0.0 ? wraps.high + 1.0 : 0.0);
  if (nearest < kLeastUnusual || !is_near(nearest) || spread > kAbove) return 0;
  return std::llround(nearest);
}

/// Those of 16 and 32 bits are continued without more evidence.
bool is_width(double number) {
  return std::any_of(kWidths.begin(), kWidths.end(),
                     [&](double width) { return std::abs(number - width) <= kWidthMiss * width; });
}

std::size_t moving_steps(const Counter& counter) {
  return static_cast<std::size_t>(
      std::count_if(counter.steps.begin(), counter.steps.end(), [](double step) { return step != 0.0; }));
}

/// The one usual number that the counts fill: a counter that wraps is everywhere in its range alike.
std::int64_t told_by_span(const Counter& counter) {
  const std::size_t moving = moving_steps(counter);
  if (moving < kFewestSteps) return 0;
  std::int64_t told = 0;
  for (const std::int64_t usual : kUsual) {
    const auto number = static_cast<double>(usual);
    if (!holds(counter.low, counter.high, number) ||
        number - 1.0 - counter.span() > 1.0 + kGaps * number / static_cast<double>(moving))
      continue;
    if (told != 0) return 0;
    told = usual;
  }
  return told;
}

/// How a counter of a known number is continued from sample to sample.
enum class Continued {
  nearest,  ///< by the shortest step
  in_line,  ///< by the step that is nearest to the one before; none at rest
};

/// Steps that the one before does not lead to.
std::size_t out_of_line(const Counter& counter, std::int64_t modulus, Continued how) {
  std::size_t found = 0;
  double before = 0.0;
  for (std::size_t k = 1; k < counter.steps.size(); ++k) {
    const bool rests = counter.steps[k] == 0.0 && counter.steps[k - 1] == 0.0;
    const double expected = how == Continued::in_line && !rests ? before : 0.0;
    const auto step = static_cast<double>(nearest_step(std::llround(counter.steps[k]), modulus, expected));
    if (std::abs(step - before) > kCoarseMiss * static_cast<double>(modulus)) ++found;
    before = step;
  }
  return found;
}

/// Nothing, where neither way makes a motion of the counts. Shortest steps come first: a count that was
/// misread leads the other way astray until the wheel rests.
std::optional<Continued> continuation(const Counter& counter, std::int64_t modulus) {
  const std::size_t nearest = out_of_line(counter, modulus, Continued::nearest);
  if (nearest == 0) return Continued::nearest;
  const std::size_t in_line = out_of_line(counter, modulus, Continued::in_line);
  if (in_line == 0) return Continued::in_line;
  const double most = kMostOutOfLine * static_cast<double>(counter.steps.size());
  if (static_cast<double>(nearest) <= most) return Continued::nearest;
  if (static_cast<double>(in_line) <= most) return Continued::in_line;
  return std::nullopt;
}

CounterModulus judged(const Counter& counter) {
  const Wraps wraps = wraps_of(counter, counter.span());
  std::int64_t modulus = told_by_jumps(wraps);
  if (modulus == 0) {
    const auto number = number_of_wraps(wraps);
    if (!number || is_width(*number)) return {};
    modulus = told_by_span(counter);
  }
  if (modulus != 0)
    if (const auto how = continuation(counter, modulus)) return {modulus, how == Continued::in_line, 0, 0.0};
  return {0, false, modulus != 0 ? modulus : std::llround(counter.span()) + 1, kWrap * counter.span()};
}

}  // namespace

std::int64_t nearest_step(std::int64_t difference, std::int64_t modulus, double expected) {
  const double wraps =
      std::round((expected - static_cast<double>(difference)) / static_cast<double>(modulus));
  return difference + modulus * std::llround(wraps);
}

std::array<CounterModulus, 2> counter_moduli(const std::vector<TickSample>& ticks) {
  std::array<CounterModulus, 2> found;
  if (ticks.size() < 4) return found;
  const std::array<Counter, 2> counters{counter_of(ticks, &TickSample::left),
                                        counter_of(ticks, &TickSample::right)};
  for (std::size_t side = 0; side < 2; ++side) found.at(side) = judged(counters.at(side));
  // A counter that wraps seldom is as the other one, and the wraps of two tell one number better.
  const double span =
      std::max(counters[0].high, counters[1].high) - std::min(counters[0].low, counters[1].low);
  const auto both = told_by_jumps(joined(wraps_of(counters[0], span), wraps_of(counters[1], span)));
  const std::array<CounterModulus, 2> alone = found;
  for (std::size_t side = 0; side < 2; ++side) {
    const std::int64_t own = alone.at(side).modulus, other = alone.at(1 - side).modulus;
    const bool is_same = both != 0 && std::abs(static_cast<double>(own - both)) <= kBelow;
    const std::int64_t modulus = is_same || other == 0 ? both : other;
    const Counter& counter = counters.at(side);
    if ((own != 0 && !is_same) || modulus == 0 ||
        !holds(counter.low, counter.high, static_cast<double>(modulus)))
      continue;
    if (const auto how = continuation(counter, modulus))
      found.at(side) = {modulus, how == Continued::in_line, 0, 0.0};
  }
  return found;
}

}  // namespace odomcalib
