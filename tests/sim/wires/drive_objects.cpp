// The node's object dictionary: what each object holds and does.
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/sim/wires/drive_node.hpp"

namespace odomcalib::sim {

namespace {

constexpr std::uint32_t kSave = 0x65766173U;  // "save" on the wire
constexpr std::uint32_t kFeedTurns = 100;
constexpr std::uint32_t kInvalid = 0x80000000U;
constexpr std::uint32_t kShortest = 1000U, kLongest = 10'000'000U;  // 1 mm to 10 m in micrometres

constexpr std::uint32_t entry(std::uint16_t index, std::uint8_t sub, std::uint8_t bits) {
  return static_cast<std::uint32_t>(index) << 16U | static_cast<std::uint32_t>(sub) << 8U | bits;
}

AbortCode one_of(std::uint32_t value, std::initializer_list<std::uint32_t> allowed) {
  for (const std::uint32_t candidate : allowed)
    if (value == candidate) return abort_code::kNone;
  return abort_code::kRange;
}

}  // namespace

void DriveNode::build_dictionary() {
  add_identity();
  add_errors();
  add_life_signs();
  add_drive_objects();
  add_targets();
  add_actual_values();
  add_geometry();
  if (options_.single_axis) add_single_axis();
  add_pdos();
}

void DriveNode::add_identity() {
  dictionary_.add_value({0x1000, 0}, 4, 0x00040192);
  dictionary_.add_text({0x1008, 0}, "ODOMCALIB-SIM-2X");
  dictionary_.add_text({0x1009, 0}, "H1.0");
  dictionary_.add_text({0x100A, 0}, "S1.0");
  const std::array<std::uint32_t, 5> identity{4, 0x00000FEE, 0x0D15, 1, options_.serial};
  for (std::size_t sub = 0; sub < identity.size(); ++sub)
    dictionary_.add_value({0x1018, static_cast<std::uint8_t>(sub)}, sub == 0 ? 1 : 4, identity[sub]);
}

void DriveNode::add_errors() {
  dictionary_.add_value({0x1001, 0}, 1, 0).mappable = true;
  dictionary_.add_value({0x1003, 0}, 1, 0, Access::read_write).before_write = [](std::uint32_t value) {
    return value == 0 ? abort_code::kNone : abort_code::kRange;
  };
  for (std::uint8_t sub = 1; sub <= 4; ++sub) dictionary_.add_value({0x1003, sub}, 4, 0);
  dictionary_.add_value({0x1014, 0}, 4, 0x080U + options_.node_id);
  dictionary_.add_value({0x603F, 0}, 4, 0).mappable = true;
}

void DriveNode::add_life_signs() {
  dictionary_.add_value({0x1016, 0}, 1, 1);
  dictionary_.add_value({0x1016, 1}, 4, 0, Access::read_write).before_write = [](std::uint32_t value) {
    return (value >> 24U) == 0 && (value >> 16U) < 128 ? abort_code::kNone : abort_code::kRange;
  };
  dictionary_.add_value({0x1017, 0}, 2, 0, Access::read_write);
  // CiA 301, 7.5.2.29: by default a communication error takes the node out of operational.
  dictionary_.add_value({0x1029, 0}, 1, 1);
  dictionary_.add_value({0x1029, 1}, 1, 0, Access::read_write).before_write = [](std::uint32_t value) {
    return one_of(value, {0, 1, 2});
  };
  dictionary_.add_value({0x6007, 0}, 2, 1, Access::read_write).before_write = [](std::uint32_t value) {
    return one_of(value, {0, 1, 2, 3});
  };
}

void DriveNode::add_drive_objects() {
  Object& control = dictionary_.add_value({0x6040, 0}, 2, 0, Access::read_write);
  control.mappable = true;
  control.after_write = [this](std::uint32_t word) { machine_.control(static_cast<std::uint16_t>(word)); };
  Object& status = dictionary_.add_value({0x6041, 0}, 4, 0);
  status.mappable = true;
  status.computed = [this] { return status_word(); };

  const auto option = [this](std::uint16_t index, int& target, std::initializer_list<std::uint32_t> allowed) {
    Object& object =
        dictionary_.add_value({index, 0}, 2, static_cast<std::uint32_t>(target), Access::read_write);
    object.before_write = [values = std::vector<std::uint32_t>(allowed)](std::uint32_t value) {
      for (const std::uint32_t known : values)
        if (value == known) return abort_code::kNone;
      return abort_code::kRange;
    };
    object.after_write = [&target](std::uint32_t value) { target = static_cast<int>(value); };
  };
  option(0x605A, machine_.options.quick_stop, {0, 1, 2, 5, 6, 7});
  option(0x605B, machine_.options.shutdown, {0, 1});
  option(0x605C, machine_.options.disable_operation, {0, 1});
  option(0x605E, machine_.options.fault_reaction, {0, 1, 2});
  dictionary_.add_value({0x605D, 0}, 2, 1);

  Object& mode = dictionary_.add_value({0x6060, 0}, 1, 0, Access::read_write);
  mode.mappable = true;
  mode.before_write = [](std::uint32_t value) { return one_of(value, {0, 3}); };
  mode.after_write = [this](std::uint32_t value) { dictionary_.set({0x6061, 0}, value); };
  dictionary_.add_value({0x6061, 0}, 1, 0).mappable = true;
  dictionary_.add_value({0x6502, 0}, 4, 0x00000004);
}

void DriveNode::add_targets() {
  for (const std::uint16_t index : {std::uint16_t{0x6083}, std::uint16_t{0x6084}, std::uint16_t{0x6085}}) {
    dictionary_.add_value({index, 0}, 1, 2);
    const std::uint32_t default_ms = index == 0x6085 ? 10 : 500;
    for (std::uint8_t sub = 1; sub <= 2; ++sub)
      dictionary_.add_value({index, sub}, 4, default_ms, Access::read_write).before_write =
          [](std::uint32_t ms) { return ms <= 32767 ? abort_code::kNone : abort_code::kRange; };
  }
  dictionary_.add_value({0x60FF, 0}, 1, 2);
  for (std::uint8_t sub = 1; sub <= 2; ++sub) {
    Object& target = dictionary_.add_value({0x60FF, sub}, 4, 0, Access::read_write);
    target.mappable = true;
    target.before_write = [](std::uint32_t raw) {
      const auto value = static_cast<std::int32_t>(raw);
      return value >= -100'000 && value <= 100'000 ? abort_code::kNone : abort_code::kRange;
    };
  }
}

void DriveNode::add_actual_values() {
  dictionary_.add_value({0x6064, 0}, 1, 2);
  dictionary_.add_value({0x606C, 0}, 1, 2);
  for (std::uint8_t sub = 1; sub <= 2; ++sub) {
    const std::size_t side = sub - 1U;
    Object& where = dictionary_.add_value({0x6064, sub}, 4, 0);
    where.mappable = true;
    where.computed = [this, side] { return position(side); };
    Object& how_fast = dictionary_.add_value({0x606C, sub}, 4, 0);
    how_fast.mappable = true;
    how_fast.computed = [this, side] { return speed(side); };
  }
  Object& clear = dictionary_.add_value({0x2005, 0}, 2, 0, Access::read_write);
  clear.before_write = [](std::uint32_t value) { return one_of(value, {1, 2, 3}); };
  clear.after_write = [this](std::uint32_t which) {
    for (std::size_t side = 0; side < 2; ++side)
      if ((which & (1U << side)) != 0) zero_[side] = wheels_.counts[side];
  };
}

void DriveNode::add_geometry() {
  dictionary_.add_value({0x2100, 0}, 1, 3);
  for (std::uint8_t sub = 1; sub <= 3; ++sub)
    dictionary_.add_value({0x2100, sub}, 4, stored_[sub - 1U], Access::read_write).before_write =
        [this](std::uint32_t um) {
          if (machine_.enabled()) return abort_code::kState;
          return um >= kShortest && um <= kLongest ? abort_code::kNone : abort_code::kRange;
        };
  dictionary_.add_value({0x1010, 0}, 1, 1);
  Object& save = dictionary_.add_value({0x1010, 1}, 4, 1, Access::read_write);
  save.computed = [] { return 1U; };  // stores on command
  save.before_write = [this](std::uint32_t signature) { return store(signature); };
}

/// The left side of the pair of axes, at the objects that CiA 402 gives a single one.
void DriveNode::add_single_axis() {
  Object& status = dictionary_.add_value({0x6041, 0}, 2, 0);
  status.mappable = true;
  status.computed = [this] { return status_word() & 0xFFFFU; };
  Object& increments = dictionary_.add_value({0x6063, 0}, 4, 0);
  increments.mappable = true;
  increments.computed = [this] { return position(0); };
  Object& where = dictionary_.add_value({0x6064, 0}, 4, 0);
  where.mappable = true;
  where.computed = [this] { return way(); };
  Object& target = dictionary_.add_value({0x60FF, 0}, 4, 0, Access::read_write);
  target.mappable = true;
  target.after_write = [this](std::uint32_t value) {
    for (std::uint8_t sub = 1; sub <= 2; ++sub) dictionary_.set({0x60FF, sub}, value);
  };
  dictionary_.add_value({0x6092, 0}, 1, 2);
  dictionary_.add_value({0x6092, 2}, 4, kFeedTurns);
  const auto feed = static_cast<std::uint32_t>(std::llround(std::numbers::pi * kFeedTurns * stored_[0]));
  dictionary_.add_value({0x6092, 1}, 4, stored_feed_.value_or(feed), Access::read_write).before_write =
      [this](std::uint32_t) { return machine_.enabled() ? abort_code::kState : abort_code::kNone; };
}

AbortCode DriveNode::store(std::uint32_t signature) {
  if (signature != kSave) return abort_code::kCannotStore;
  if (machine_.enabled()) return abort_code::kState;
  if (faults.store_fails) return abort_code::kHardware;
  ++store_count_;
  if (faults.store_is_lost) return abort_code::kNone;
  stored_ = geometry_in_ram();
  if (options_.single_axis) stored_feed_ = dictionary_.value({0x6092, 1});
  return abort_code::kNone;
}

std::array<std::uint32_t, 3> DriveNode::geometry_in_ram() const {
  return {dictionary_.value({0x2100, 1}), dictionary_.value({0x2100, 2}), dictionary_.value({0x2100, 3})};
}

void DriveNode::add_pdos() {
  tpdos_.clear();
  rpdos_.clear();
  const std::uint32_t id = options_.node_id;
  const auto configurable = [this] { return nmt_ != NmtState::operational; };
  const std::array<PdoDefaults, 4> transmit{{
      {0x180 + id, 20, {entry(0x6064, 1, 32), entry(0x6064, 2, 32)}},
      {0x280 + id, 50, {entry(0x6041, 0, 32), entry(0x603F, 0, 32)}},
      {kInvalid | (0x380 + id), 0, {}},
      {kInvalid | (0x480 + id), 0, {}},
  }};
  const std::array<PdoDefaults, 4> receive{{
      {0x200 + id, 0, {entry(0x6040, 0, 16)}},
      {0x300 + id, 0, {entry(0x60FF, 1, 32), entry(0x60FF, 2, 32)}},
      {kInvalid | (0x400 + id), 0, {}},
      {kInvalid | (0x500 + id), 0, {}},
  }};
  for (std::uint16_t i = 0; i < 4; ++i) {
    tpdos_.emplace_back(dictionary_, 0x1800 + i, 0x1A00 + i, transmit[i], configurable);
    rpdos_.emplace_back(dictionary_, 0x1400 + i, 0x1600 + i, receive[i], configurable);
  }
}

std::uint32_t DriveNode::status_word() const {
  std::uint32_t both = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    const double rate = std::abs(wheels_.rate[side]);
    const auto target =
        static_cast<std::int32_t>(dictionary_.value({0x60FF, static_cast<std::uint8_t>(side + 1)}));
    const double missing = std::abs(wheels_.rate[side] - 0.01 * target * std::numbers::pi / 30.0);
    std::uint32_t word = machine_.status_bits();
    if (missing < 0.05) word |= 0x0400U;  // target reached
    word |= rate < 0.05 ? 0x1000U : 0x4000U;
    both |= word << (16U * side);
  }
  return both;
}

std::uint32_t DriveNode::position(std::size_t side) const {
  const std::size_t from = faults.swap_sides ? 1 - side : side;
  return static_cast<std::uint32_t>(wheels_.counts[from] - zero_[from]);
}

/// In position units, by the book: increments times feed over resolution and turns. Another feed is another
/// way for the same increments.
std::uint32_t DriveNode::way() const {
  const double turns =
      static_cast<double>(static_cast<std::int32_t>(position(0))) / options_.increments_per_turn;
  const double um = turns * dictionary_.value({0x6092, 1}) / kFeedTurns;
  return static_cast<std::uint32_t>(std::llround(um));
}

std::uint32_t DriveNode::speed(std::size_t side) const {
  const std::size_t from = faults.swap_sides ? 1 - side : side;
  const double tenths_of_rpm = wheels_.rate[from] * 30.0 / std::numbers::pi * 10.0;
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(tenths_of_rpm)));
}

}  // namespace odomcalib::sim
