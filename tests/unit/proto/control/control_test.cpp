#include "proto/control/control.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/value_of.hpp"

namespace odomcalib::control::control_test {
namespace {

std::vector<std::string> frames_of(FrameDecoder& decoder, std::string_view bytes, std::size_t step) {
  std::vector<std::string> frames;
  while (!bytes.empty()) {
    const auto part = bytes.substr(0, step);
    decoder.feed(part);
    bytes.remove_prefix(part.size());
    while (auto frame = decoder.next()) frames.push_back(*frame);
  }
  return frames;
}

void expect_all_bytes_accounted(const FrameDecoder& decoder) {
  const auto& c = decoder.counters();
  EXPECT_EQ(c.bytes_in, c.good + c.skipped + decoder.buffered());
}

TEST(ControlFrames, come_out_the_same_for_every_cut_of_the_stream) {
  const std::string stream = encode_call({.method = "org.odomcalib.Calibration.GetStatus"}) +
                             encode_reply(R"({"status":{"state":"idle"}})") + std::string(1, '\0') + "rest";
  for (std::size_t step = 1; step <= stream.size(); ++step) {
    FrameDecoder decoder;
    const auto frames = frames_of(decoder, stream, step);
    ASSERT_EQ(frames.size(), 2U) << "step " << step;
    EXPECT_TRUE(decode_call(frames[0]).ok());
    EXPECT_TRUE(decode_reply(frames[1]).ok());
    EXPECT_EQ(decoder.buffered(), 4U);
    EXPECT_EQ(decoder.counters().empty, 1U);
    expect_all_bytes_accounted(decoder);
  }
}

TEST(ControlFrames, reject_a_frame_beyond_one_mebibyte_and_go_on_behind_it) {
  const std::string good = encode_reply("{}");
  for (const std::size_t size : {kLargestFrame, kLargestFrame + 1, 3 * kLargestFrame}) {
    for (const std::size_t step : {std::size_t{4096}, std::size_t{1} << 24}) {
      FrameDecoder decoder;
      const auto frames = frames_of(decoder, std::string(size, 'x') + '\0' + good, step);
      EXPECT_EQ(frames.size(), size > kLargestFrame ? 1U : 2U) << size << " by " << step;
      EXPECT_EQ(decoder.counters().oversized, size > kLargestFrame ? 1U : 0U);
      EXPECT_EQ(decoder.buffered(), 0U);
      expect_all_bytes_accounted(decoder);
    }
  }
}

TEST(ControlFrames, account_for_every_byte_of_random_streams) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 200; ++round) {
    std::string bytes(random() % 300, '\0');
    for (char& c : bytes) c = static_cast<char>(random() % 5 == 0 ? 0 : random());
    FrameDecoder decoder;
    for (const auto& frame : frames_of(decoder, bytes, 1 + random() % 50)) {
      (void)decode_call(frame).ok();
      (void)decode_reply(frame).ok();
    }
    expect_all_bytes_accounted(decoder);
  }
}

std::string unframed(std::string frame) {
  EXPECT_EQ(frame.back(), '\0');
  frame.pop_back();
  return frame;
}

TEST(ControlCall, survives_encoding) {
  const Call call{.method = "org.odomcalib.Calibration.Straight",
                  .parameters = nlohmann::ordered_json::parse(R"({"lease":"a\u0000b","distance":-1.5})"),
                  .oneway = true,
                  .more = true,
                  .upgrade = true};
  const auto back = value_of(decode_call(unframed(encode_call(call))));
  EXPECT_EQ(back.method, call.method);
  EXPECT_EQ(back.parameters, call.parameters);
  EXPECT_TRUE(back.oneway && back.more && back.upgrade);
  EXPECT_EQ(back.interface(), kInterface);
  EXPECT_EQ(back.name(), "Straight");
}

TEST(ControlCall, is_refused_when_malformed) {
  const std::string deep =
      R"({"method":"a.B","parameters":{"x":)" + std::string(40, '[') + std::string(40, ']') + "}}";
  for (const std::string text :
       {"", "{", "[]", "1", "{}", R"({"method":1})", R"({"method":"NoInterface"})", R"({"method":"a..B"})",
        R"({"method":"a.9"})", R"({"method":"a.B","parameters":[]})", R"({"method":"a.B","more":"yes"})",
        deep.c_str(), "{\"method\":\"a.\xff\"}"}) {
    const auto call = decode_call(text);
    ASSERT_FALSE(call.ok()) << text;
    EXPECT_EQ(call.error().code, ErrorCode::format);
  }
  EXPECT_TRUE(decode_call(R"({"method":"a.B"})").ok());
  const std::string allowed =
      R"({"method":"a.B","parameters":{"x":)" + std::string(30, '[') + std::string(30, ']') + "}}";
  EXPECT_TRUE(decode_call(allowed).ok());
}

TEST(ControlReply, carries_every_error_code_with_its_texts) {
  for (int i = 0; i <= static_cast<int>(ErrorCode::busy); ++i) {
    const Error error{static_cast<ErrorCode>(i), "it \"broke\"", "can0", "plug it in"};
    const auto reply = value_of(decode_reply(unframed(encode_error(error))));
    const auto back = error_of(reply);
    EXPECT_EQ(back.code, error.code);
    EXPECT_EQ(back.text(), error.text());
    const auto name = reply.error.substr(kInterface.size() + 1);
    EXPECT_NE(interface_description().find("\nerror " + name + " ("), std::string_view::npos) << name;
  }
}

TEST(ControlReply, of_another_service_is_an_error_too) {
  const auto reply = value_of(decode_reply(unframed(encode_method_not_found("a.B"))));
  EXPECT_EQ(error_of(reply).code, ErrorCode::usage);
  EXPECT_EQ(error_of({.parameters = "{}", .continues = false, .error = "com.example.Odd"}).code,
            ErrorCode::io);
}

TEST(ControlReply, tells_whether_it_continues) {
  EXPECT_TRUE(decode_reply(unframed(encode_reply("{}", true))).value().continues);
  EXPECT_FALSE(decode_reply(unframed(encode_reply("{}"))).value().continues);
  EXPECT_EQ(decode_reply(unframed(encode_reply("no json"))).value().parameters, "{}");
}

Reply introspect(const std::string& method, const std::string& parameters = "{}") {
  const auto frame = answer_introspection(
      {.method = method, .parameters = nlohmann::ordered_json::parse(parameters)}, {.version = "1.2.3"});
  EXPECT_TRUE(frame.has_value()) << method;
  return decode_reply(unframed(frame.value_or(std::string(1, '\0')))).value();
}

TEST(ControlIntrospection, answers_info_and_descriptions) {
  const auto info = introspect("org.varlink.service.GetInfo");
  EXPECT_EQ(info.error, "");
  EXPECT_NE(info.parameters.find(R"("version":"1.2.3")"), std::string::npos);
  EXPECT_NE(info.parameters.find(R"("interfaces":["org.varlink.service","org.odomcalib.Calibration"])"),
            std::string::npos);
  const auto own = introspect("org.varlink.service.GetInterfaceDescription",
                              R"({"interface":"org.odomcalib.Calibration"})");
  EXPECT_NE(own.parameters.find("method GetStatus()"), std::string::npos);
  const auto service =
      introspect("org.varlink.service.GetInterfaceDescription", R"({"interface":"org.varlink.service"})");
  EXPECT_NE(service.parameters.find("method GetInfo()"), std::string::npos);
}

TEST(ControlIntrospection, names_what_it_does_not_know) {
  EXPECT_EQ(introspect("org.varlink.service.Nope").error, "org.varlink.service.MethodNotFound");
  EXPECT_EQ(introspect("org.odomcalib.Calibration.Nope").error, "org.varlink.service.MethodNotFound");
  EXPECT_EQ(introspect("com.example.Nope").error, "org.varlink.service.InterfaceNotFound");
  EXPECT_EQ(introspect("org.varlink.service.GetInterfaceDescription").error,
            "org.varlink.service.InvalidParameter");
  EXPECT_EQ(introspect("org.varlink.service.GetInterfaceDescription", R"({"interface":"x.y"})").error,
            "org.varlink.service.InterfaceNotFound");
}

TEST(ControlIntrospection, leaves_the_daemons_own_methods_to_the_daemon) {
  for (const char* name : {"GetStatus", "Acquire", "Renew", "Release", "Straight", "Spin", "Calibrate",
                           "Record", "Stop", "GetParameters", "Apply", "History", "Rollback"})
    EXPECT_FALSE(answer_introspection({.method = std::string(kInterface) + "." + name}, {}).has_value())
        << name;
  EXPECT_FALSE(has_method("Get"));
  EXPECT_FALSE(has_method("GetStatus() -> (status: object)\n\nmethod Describe"));
}

}  // namespace
}  // namespace odomcalib::control::control_test
