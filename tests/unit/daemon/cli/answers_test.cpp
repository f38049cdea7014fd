// Answers of a daemon of another version do not read as "all is well", nor one without its socket as gone.
#include "daemon/cli/client.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/temporary_folder.hpp"

namespace odomcalib::cli::answers_test {
namespace {

using nlohmann::ordered_json;

TEST(Answers, without_their_member_are_errors_that_name_it) {
  for (const char* text : {"{}", "[]", "null", "no JSON", R"({"check":[]})"}) {
    const auto answer = answer_with(ordered_json::parse(text, nullptr, false), "Check", "checks");
    ASSERT_FALSE(answer.ok()) << text;
    EXPECT_EQ(answer.error().code, ErrorCode::format);
    EXPECT_EQ(answer.error().what, "the daemon's answer has no checks");
  }
  EXPECT_TRUE(answer_with({{"checks", ordered_json::array()}}, "Check", "checks").ok());
  EXPECT_TRUE(answer_with(ordered_json::object(), "Stop", "").ok());
  EXPECT_FALSE(answer_with(ordered_json::array(), "Stop", "").ok());
}

TEST(Answers, with_an_outcome_that_is_not_known_stand_in_the_way) {
  for (const char* text : {R"({"outcome":"fail"})", R"({"outcome":"failed"})", R"({"outcome":1})", "{}", "3"})
    EXPECT_TRUE(stands_in_the_way(ordered_json::parse(text))) << text;
  for (const char* text : {R"({"outcome":"ok"})", R"({"outcome":"warn"})"})
    EXPECT_FALSE(stands_in_the_way(ordered_json::parse(text))) << text;
}

TEST(Connection, to_a_socket_whose_file_is_gone_says_that_the_daemon_runs) {
  const TemporaryFolder folder;
  const std::string path = folder / "control";
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(std::begin(address.sun_path), sizeof(address.sun_path) - 1);
  const auto error_of = [&path] {
    const auto client = Client::connect(path);
    return client ? "" : client.error().text();
  };
  EXPECT_EQ(error_of(), path + ": odomcalibd is not running; start it with: systemctl start odomcalib");
  const int listener = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  EXPECT_EQ(error_of(), "");
  unlink(path.c_str());
  EXPECT_EQ(error_of(),
            path +
                ": odomcalibd runs, but somebody removed its control socket; restart it with: systemctl "
                "restart odomcalib");
  close(listener);
  EXPECT_EQ(error_of(), path + ": odomcalibd is not running; start it with: systemctl start odomcalib");
}

}  // namespace
}  // namespace odomcalib::cli::answers_test
