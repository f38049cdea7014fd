// Duties of every lidar driver whatever arrives: each byte accounted for, finite scans, no wrong frame
// accepted.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "drivers/decode/decode.hpp"
#include "drivers/lidar/lidar.hpp"
#include "tests/sim/wires/cola_device.hpp"
#include "tests/sim/wires/ld06_stream.hpp"
#include "tests/sim/wires/rplidar_device.hpp"
#include "tests/sim/wires/scip_device.hpp"
#include "tests/sim/wires/xv11_device.hpp"
#include "tests/sim/wires/ydlidar_device.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::lidar_malformed_test {
namespace {

using test::ByteString;
using test::expect_accounted;

/// A protocol and half a second of a device's bytes.
struct Stream {
  std::string type;
  std::string bytes;
};

/// Bytes of a device that the driver itself starts.
Stream recorded(const std::string& type, sim::LidarDevice& device, double seconds) {
  const auto lidar = std::move(make_lidar(type, {})).value();
  Stream out{type, ""};
  for (double now = 0.0; now < seconds; now += 1e-3) {
    device.advance(now);
    const std::string bytes = device.take(now);
    out.bytes += bytes;
    lidar->on_bytes(test::bytes_of(bytes), now);
    const auto output = lidar->take_output();
    device.from_host({reinterpret_cast<const char*>(output.data()), output.size()}, now);
  }
  return out;
}

/// An LD06 speaks unasked.
Stream ld06_stream(double seconds) {
  Stream out{"ld06", ""};
  const double packet_s = 12.0 / 4500.0;
  for (int k = 0; k * packet_s < seconds; ++k) {
    sim::Ld06Packet packet;
    packet.speed = 3600.0;
    packet.start_angle = std::fmod(9.6 * k, 360.0);
    packet.end_angle = std::fmod(9.6 * k + 8.8, 360.0);
    packet.time = packet_s * (k + 1);
    packet.points.resize(12);
    for (std::size_t i = 0; i < packet.points.size(); ++i)
      packet.points[i].range = 1.0 + 0.01 * static_cast<double>(i);
    const auto bytes = sim::encode_ld06(packet);
    out.bytes.append(bytes.begin(), bytes.end());
  }
  return out;
}

std::vector<Stream> make_streams() {
  using Rp = sim::RplidarDevice;
  std::vector<Stream> out;
  for (const auto data : {Rp::Data::standard, Rp::Data::express, Rp::Data::dense}) {
    Rp::Options options;
    options.data = data;
    options.bytes_per_s = 25'600.0;
    Rp device(options);
    out.push_back(recorded("rplidar", device, 0.5));
  }
  sim::YdlidarDevice two_bytes(sim::YdlidarDevice::Options{}), three_bytes({true, true, true});
  out.push_back(recorded("ydlidar:x4", two_bytes, 0.5));
  out.push_back(recorded("ydlidar:g2", three_bytes, 0.5));
  sim::ScipDevice hokuyo(sim::ScipDevice::Options{});
  out.push_back(recorded("hokuyo", hokuyo, 0.4));
  sim::ColaDevice binary(sim::ColaDevice::Options{}), ascii({false});
  out.push_back(recorded("sick", binary, 0.3));
  out.push_back(recorded("sick", ascii, 1.3));
  sim::Xv11Device neato(sim::Xv11Device::Options{});
  out.push_back(recorded("xv11", neato, 0.5));
  out.push_back(ld06_stream(0.5));
  return out;
}

const std::vector<Stream>& streams() {
  static const std::vector<Stream> kStreams = make_streams();
  return kStreams;
}

std::unique_ptr<Lidar> offline(const std::string& type) {
  LidarOptions options;
  options.device_time = true;
  return std::move(make_lidar(type, options)).value();
}

std::string scans_of(const std::string& type, const std::string& bytes, std::size_t piece) {
  const auto lidar = offline(type);
  std::ostringstream out;
  const auto show = [&] {
    for (const LidarScan& given : lidar->take_scans()) {
      EXPECT_TRUE(std::isfinite(given.scan.t));
      out << given.partial << ' ' << given.scan.t << ' ' << given.scan.angle_min << ':';
      for (const float range : given.scan.ranges) {
        EXPECT_TRUE(std::isfinite(range) && range >= 0.0F);
        out << ' ' << range;
      }
      out << '\n';
    }
  };
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    lidar->on_bytes(test::bytes_of(bytes.substr(at, piece)), 0.0);
    expect_accounted(lidar->counters());
    show();
  }
  lidar->finish();
  show();
  return out.str();
}

TEST(EveryLidar, gives_the_same_scans_however_its_bytes_are_cut) {
  for (const Stream& stream : streams()) {
    const std::string whole = scans_of(stream.type, stream.bytes, stream.bytes.size());
    EXPECT_GT(whole.size(), 100U) << stream.type;
    const std::string head = stream.bytes.substr(0, 6000);
    EXPECT_EQ(scans_of(stream.type, head, 1), scans_of(stream.type, head, head.size())) << stream.type;
    for (const std::size_t piece : {7UL, 64UL, 1448UL})
      EXPECT_EQ(scans_of(stream.type, stream.bytes, piece), whole)
          << stream.type << " in pieces of " << piece;
  }
}

/// One of the ways in which bytes go wrong.
std::string damaged(std::string bytes, test::Random& random) {
  const std::size_t at = random() % bytes.size();
  const std::size_t size = 1 + random() % 40;
  switch (random() % 6) {
    case 0:  // cut off
      return bytes.substr(0, at);
    case 1:  // a hole
      return bytes.erase(at, size);
    case 2:  // sent twice
      return bytes.insert(at, bytes.substr(at, size));
    case 3:  // a bit
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
      return bytes;
    case 4: {  // noise between
      std::string noise(size, '\0');
      for (char& c : noise) c = static_cast<char>(random());
      return bytes.insert(at, noise);
    }
    default:  // a byte at one of its limits, as counts and lengths go wrong
      bytes[at] = random() % 2 == 0 ? '\0' : '\xFF';
      return bytes;
  }
}

TEST(EveryLidar, survives_damaged_bytes_and_accounts_for_each) {
  auto random = test::seeded(21);
  for (const Stream& stream : streams())
    for (int i = 0; i < 1000; ++i) {
      const std::size_t size = std::min<std::size_t>(stream.bytes.size(), 3000);
      const std::size_t from = random() % (stream.bytes.size() - size + 1);
      std::string bytes = stream.bytes.substr(from, size);
      for (unsigned n = 1 + random() % 3; n > 0 && !bytes.empty(); --n) bytes = damaged(bytes, random);
      (void)scans_of(stream.type, bytes, 1 + random() % 700);
    }
}

TEST(EveryLidar, survives_noise) {
  auto random = test::seeded(22);
  for (const Stream& stream : streams())
    for (int i = 0; i < 100; ++i) {
      std::string bytes(500, '\0');
      for (char& c : bytes) c = static_cast<char>(random());
      (void)scans_of(stream.type, bytes, 1 + random() % 500);
    }
}

/// Good bytes of a stream, all that was given.
std::uint64_t good_bytes(const std::string& type, const std::string& bytes) {
  const auto lidar = offline(type);
  lidar->on_bytes(test::bytes_of(bytes), 0.0);
  return lidar->counters().at("good");
}

std::string from_hex(const std::string& digits) { return sim::text_of_hex(digits); }

TEST(EveryLidar, rejects_a_frame_with_any_bit_flipped) {
  // One frame of each protocol whose checksum covers everything.
  std::string xv11 = from_hex("fab16b4cd8406000d1000b01cc00d402c80077022927");
  std::string ydlidar = from_hex("aa55010153ae53aeab540000");
  std::string sick = from_hex("0202020200000013735241205343646576696365737461746520001f00");
  sick.pop_back();
  const std::string hokuyo = "PP\n00P\nDMIN:23;7\n\n";
  const std::string ld06 = streams().back().bytes.substr(0, 47);
  for (const auto& [type, frame] : std::vector<std::pair<std::string, std::string>>{
           {"xv11", xv11}, {"ydlidar", ydlidar}, {"sick", sick}, {"hokuyo", hokuyo}, {"ld06", ld06}}) {
    EXPECT_EQ(good_bytes(type, frame), frame.size()) << type;
    for (std::size_t at = 0; at < frame.size(); ++at)
      for (int bit = 0; bit < 8; ++bit) {
        if (type == "hokuyo" && (at < 3 || bit >= 6)) continue;  // no sum over the echo; sums of six bits
        std::string bad = frame;
        bad[at] = static_cast<char>(bad[at] ^ (1 << bit));
        EXPECT_EQ(good_bytes(type, bad), 0U) << type << " byte " << at << " bit " << bit;
      }
  }
}

TEST(EveryLidar, rejects_a_capsule_with_any_bit_flipped) {
  std::string capsule(84, '\0');
  for (std::size_t i = 2; i < capsule.size(); ++i) capsule[i] = static_cast<char>(i * 7);
  unsigned sum = 0;
  for (std::size_t i = 2; i < capsule.size(); ++i) sum ^= static_cast<unsigned char>(capsule[i]);
  capsule[0] = static_cast<char>(0xA0 | (sum & 15U));
  capsule[1] = static_cast<char>(0x50 | sum >> 4U);
  const std::string descriptor = from_hex("A55A5400004082");
  EXPECT_EQ(good_bytes("rplidar", descriptor + capsule), 91U);
  for (std::size_t at = 0; at < capsule.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      std::string bad = capsule;
      bad[at] = static_cast<char>(bad[at] ^ (1 << bit));
      EXPECT_EQ(good_bytes("rplidar", descriptor + bad), 7U) << "byte " << at << " bit " << bit;
    }
}

TEST(Rplidar, an_unknown_form_of_measurements_is_named_and_never_decoded) {
  const auto lidar = offline("rplidar");
  std::string bytes = from_hex("A55A8400004099");
  for (int i = 0; i < 50; ++i) bytes += streams()[1].bytes.substr(200, 84);
  lidar->on_bytes(test::bytes_of(bytes), 0.0);
  lidar->finish();
  EXPECT_TRUE(lidar->take_scans().empty());
  EXPECT_EQ(lidar->counters().at("unknown_packet_type"), 1U);
  ASSERT_TRUE(lidar->problem());
  EXPECT_NE(lidar->problem()->text().find("rplidar:standard"), std::string::npos);
}

/// The stream without its descriptors, from somewhere in the middle.
std::string late(const std::string& bytes, std::size_t share) { return bytes.substr(bytes.size() / share); }

std::vector<float> ranges_of(Lidar& lidar, const std::string& bytes) {
  lidar.on_bytes(test::bytes_of(bytes), 0.0);
  lidar.finish();
  std::vector<float> out;
  for (const LidarScan& given : lidar.take_scans())
    out.insert(out.end(), given.scan.ranges.begin(), given.scan.ranges.end());
  return out;
}

TEST(Rplidar, capsules_of_a_recording_that_begins_late_are_told_by_their_distances) {
  for (const std::size_t share : {3U, 4U, 5U}) {
    const std::string express = late(streams()[1].bytes, share), dense = late(streams()[2].bytes, share);
    const auto any_express = offline("rplidar"), any_dense = offline("rplidar");
    const auto told_express = offline("rplidar:express"), told_dense = offline("rplidar:dense");
    const auto expected = ranges_of(*told_express, express);
    EXPECT_GT(expected.size(), 200U);
    EXPECT_EQ(ranges_of(*any_express, express), expected);
    const auto expected_dense = ranges_of(*told_dense, dense);
    EXPECT_GT(expected_dense.size(), 200U);
    EXPECT_EQ(ranges_of(*any_dense, dense), expected_dense);
    EXPECT_FALSE(any_express->problem() || any_dense->problem());
  }
}

std::string capsule_of(const std::function<unsigned char(std::size_t)>& content, std::size_t size = 84) {
  std::string capsule(size, '\0');
  unsigned sum = 0;
  for (std::size_t i = 2; i < size; ++i) {
    const unsigned char byte = content(i);
    capsule[i] = static_cast<char>(byte);
    sum ^= byte;
  }
  capsule[0] = static_cast<char>(0xA0 | (sum & 15U));
  capsule[1] = static_cast<char>(0x50 | sum >> 4U);
  return capsule;
}

TEST(Rplidar, capsules_that_do_not_show_their_layout_are_named_and_never_decoded) {
  auto random = test::seeded(23);
  for (const std::size_t capsules : {3U, 40U}) {
    std::string noise, nothing;
    for (std::size_t k = 0; k < capsules; ++k) {
      const auto angle = static_cast<unsigned char>(8 * k);
      noise += capsule_of([&](std::size_t i) {
        return i == 2 ? angle : i == 3 ? 0 : static_cast<unsigned char>(test::random_byte(random));
      });
      nothing += capsule_of([&](std::size_t i) { return i == 2 ? angle : 0; });
    }
    for (const std::string& bytes : {noise, nothing}) {
      const auto lidar = offline("rplidar");
      EXPECT_TRUE(ranges_of(*lidar, bytes).empty());
      EXPECT_GE(lidar->counters().at("ambiguous_capsule"), 1U);
      ASSERT_TRUE(lidar->problem());
      EXPECT_NE(lidar->problem()->text().find("rplidar:dense"), std::string::npos);
      EXPECT_FALSE(ranges_of(*offline("rplidar:dense"), bytes).empty());  // said by the user: as said
    }
  }
}

/// The first 84 bytes of a longer capsule have the right checksum of a shorter one by chance.
TEST(Rplidar, a_checksum_that_fits_by_chance_does_not_tell_the_type) {
  std::string bytes;
  for (std::size_t k = 0; k < 6; ++k) {
    const auto content = [&](std::size_t i) {
      return static_cast<unsigned char>(i == 2 ? 16 * k : i == 3 ? 4 : i * 3);
    };
    unsigned end = 0;
    for (std::size_t i = 84; i < 132; ++i) end ^= content(i);
    // The last byte makes the rest cancel out: both checksums agree.
    bytes += capsule_of(
        [&](std::size_t i) { return i == 131 ? static_cast<unsigned char>(content(i) ^ end) : content(i); },
        132);
  }
  const auto lidar = offline("rplidar");
  std::string form;
  lidar->set_listener([&](const LidarMessage& message) { form = message.name; });
  (void)ranges_of(*lidar, bytes);
  EXPECT_EQ(form, "rplidar_ultra");
}

TEST(Hokuyo, measurements_without_known_geometry_are_no_scans) {
  const std::string& session = streams()[5].bytes;
  const std::string scans = session.substr(session.find("MD0000"));
  const auto lidar = offline("hokuyo");
  lidar->on_bytes(test::bytes_of(scans), 0.0);
  EXPECT_TRUE(lidar->take_scans().empty());
  EXPECT_GT(lidar->counters().at("no_parameters"), 0U);
  const auto told = offline("hokuyo:utm30lx");
  told->on_bytes(test::bytes_of(scans), 0.0);
  EXPECT_FALSE(told->take_scans().empty());
}

}  // namespace
}  // namespace odomcalib::drivers::lidar_malformed_test
