// Calls that clients send at once: who is served, in which order, and that a stop waits for nobody.
#include "daemon/service/control_server.hpp"

#include <grp.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <array>
#include <functional>
#include <numeric>

#include "tests/temporary_folder.hpp"
#include "tests/unit/daemon/service/control_client.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::control_server_test {
namespace {

class Burst : public testing::Test {
 protected:
  void SetUp() override {
    server_.emplace(value_of(ControlServer::create(folder_ / "control", "nobody-has-this-group")));
  }
  /// A client that the server has accepted.
  std::unique_ptr<ControlClient> client() {
    auto made = std::make_unique<ControlClient>(folder_ / "control");
    step();
    return made;
  }
  void step() { server_->step(now_ += 0.01); }
  /// Names of the calls of one turn, with the number of their client behind.
  std::vector<std::string> turn() {
    step();
    std::vector<std::string> names;
    while (auto call = server_->next_call())
      names.push_back(call->call.name() + std::to_string(call->client) + (call->stopped_since ? "!" : ""));
    return names;
  }

  const TemporaryFolder folder_;
  std::optional<ControlServer> server_;
  double now_ = 1.0;
};

TEST_F(Burst, is_served_a_few_calls_a_turn_and_whole_in_the_end) {
  const auto one = client();
  one->send(40, "GetStatus");
  std::vector<std::size_t> turns;
  turns.reserve(4);
  for (int i = 0; i < 4; ++i) turns.push_back(turn().size());
  EXPECT_EQ(turns, (std::vector<std::size_t>{16, 16, 8, 0}));
  EXPECT_FALSE(server_->calls_wait());
}

TEST_F(Burst, of_one_client_leaves_the_others_their_turn) {
  const auto one = client(), two = client();
  one->send(600, "History");
  two->send(1, "Renew");
  const auto served = turn();
  ASSERT_EQ(served.size(), ControlServer::kCallsPerTurn + 1);
  EXPECT_EQ(std::vector(served.begin(), served.begin() + 2),
            (std::vector<std::string>{"History1", "Renew2"}));
  EXPECT_TRUE(server_->calls_wait());
}

TEST_F(Burst, whose_turn_was_cut_short_does_not_begin_with_the_same_client_again) {
  const auto one = client(), two = client();
  one->send(2, "History");
  two->send(2, "GetStatus");
  step();
  EXPECT_EQ(server_->next_call()->client, 1U);
  step();
  EXPECT_EQ(server_->next_call()->client, 2U);
}

TEST_F(Burst, is_overtaken_by_the_stop_at_its_end) {
  const auto one = client();
  one->send(600, "History");
  one->send(1, "Stop");
  step();
  EXPECT_TRUE(server_->take_stop());
  EXPECT_FALSE(server_->take_stop()) << "obeyed once";
}

TEST_F(Burst, of_one_client_is_overtaken_by_the_stop_of_another) {
  const auto one = client(), two = client();
  one->send(20, "Straight");
  EXPECT_EQ(turn().front(), "Straight1");
  two->send(1, "Stop");
  step();
  EXPECT_TRUE(server_->take_stop());
  one->send(1, "Straight");
  EXPECT_EQ(turn(), (std::vector<std::string>{"Stop2!", "Straight1!", "Straight1!", "Straight1!",
                                              "Straight1!", "Straight1"}))
      << "what waited is marked, what comes later is not";
}

TEST_F(Burst, without_a_stop_stops_nothing) {
  const auto one = client();
  one->send_text(R"({"method":"org.odomcalib.Calibration.Record","parameters":{"name":"Stop"}})");
  one->send_text(
      R"({"method":"org.odomcalib.Calibration.Check","parameters":{"x":"org.odomcalib.Calibration.Stop"}})");
  one->send_text(R"({"method":"org.example.Stop"})");
  step();
  EXPECT_FALSE(server_->take_stop());
}

TEST_F(Burst, keeps_the_order_of_answers_whoever_gives_them) {
  const auto one = client();
  one->send(1, "GetStatus");
  one->send_text(R"({"method":"org.varlink.service.GetInfo"})");
  one->send(1, "Stop");
  step();
  EXPECT_TRUE(server_->take_stop());
  EXPECT_EQ(server_->next_call()->call.name(), "GetStatus");
  server_->reply(1, control::encode_reply(R"({"first":1})"));
  EXPECT_EQ(server_->next_call()->call.name(), "Stop");
  server_->reply(1, control::encode_reply(R"({"third":3})"));
  const auto answers = one->answers();
  ASSERT_EQ(answers.size(), 3U);
  EXPECT_NE(answers[0].parameters.find("first"), std::string::npos);
  EXPECT_NE(answers[1].parameters.find("odomcalibd"), std::string::npos);
  EXPECT_NE(answers[2].parameters.find("third"), std::string::npos);
}

TEST_F(Burst, that_is_no_call_is_answered_with_what_is_wrong_before_the_connection_ends) {
  const std::vector<std::array<std::string, 3>> cases{{
      {R"({"method":"Ping"})", "org.varlink.service.MethodNotFound", "Ping"},
      {R"({"method":"org.odomcalib.Calibration.GetStatus","parameters":[1]})",
       "org.varlink.service.InvalidParameter", "parameters"},
      {R"({"parameters":{}})", "org.varlink.service.InvalidParameter", "method"},
      {R"({"method":"a.B","more":1})", "org.varlink.service.InvalidParameter", "more"},
      {R"({"method":"a.B","upgrade":1})", "org.varlink.service.InvalidParameter", "upgrade"},
      {R"({"method":"a.B","oneway":1})", "org.varlink.service.InvalidParameter", "oneway"},
      {"[1,2]", "org.odomcalib.Calibration.Format", "JSON object"},
      {"{\"method", "org.odomcalib.Calibration.Format", "JSON object"},
  }};
  std::uint64_t malformed = 0;
  for (const auto& [text, error, named] : cases) {
    const auto one = client();
    one->send_text(text);
    one->send(1, "GetStatus");
    EXPECT_TRUE(turn().empty()) << text;
    const auto answers = one->answers();
    ASSERT_EQ(answers.size(), 1U) << text;
    EXPECT_EQ(answers[0].error, error) << text;
    EXPECT_NE(answers[0].parameters.find(named), std::string::npos) << answers[0].parameters;
    step();
    EXPECT_EQ(server_->clients(), 0U) << text;
    EXPECT_EQ(server_->counters().malformed, ++malformed);
  }
  const auto one = client();
  one->send_text(R"({"method":"Ping","oneway":true})");
  EXPECT_TRUE(turn().empty());
  EXPECT_TRUE(one->answers().empty()) << "it asked for no answer";
}

TEST_F(Burst, says_when_each_call_arrived) {
  const auto one = client();
  one->send(17, "Renew");
  step();
  const double arrived = now_;
  for (int i = 0; i < 16; ++i) EXPECT_EQ(server_->next_call()->arrived, arrived);
  step();
  EXPECT_EQ(server_->next_call()->arrived, arrived);
}

TEST_F(Burst, that_does_not_end_ends_the_connection) {
  const auto one = client(), two = client();
  std::size_t sent = 0;
  for (int i = 0; i < 200 && server_->connected(1); ++i) {
    sent += one->send(600, "History");
    step();
  }
  EXPECT_FALSE(server_->connected(1));
  EXPECT_TRUE(server_->connected(2));
  EXPECT_EQ(server_->counters().flooded, 1U);
  EXPECT_GT(sent, ControlServer::kMostWaiting);
  EXPECT_EQ(server_->take_gone(), (std::vector<ClientId>{1}));
}

TEST_F(Burst, of_a_client_that_is_gone_is_dropped_with_it) {
  auto one = client();
  one->send(100, "Renew");
  EXPECT_EQ(turn().size(), 16U);
  one.reset();
  EXPECT_TRUE(turn().empty());
  EXPECT_EQ(server_->take_gone(), (std::vector<ClientId>{1}));
}

TEST_F(Burst, a_client_that_does_not_read_is_dropped) {
  const auto one = client(), two = client();
  const std::string frame = control::encode_reply(R"({"text":")" + std::string(100'000, 'x') + R"("})");
  for (int i = 0; i < 60; ++i) server_->reply(1, frame);
  step();
  EXPECT_TRUE(server_->connected(1)) << "some megabytes may wait";
  for (int i = 0; i < 60; ++i) server_->reply(1, frame);
  step();
  EXPECT_FALSE(server_->connected(1));
  EXPECT_TRUE(server_->connected(2));
  EXPECT_EQ(server_->counters().too_slow, 1U);
}

constexpr uid_t kNobody = 65534;  // of Debian: in no group of importance

TEST(Permission, is_for_root_the_own_user_and_the_group_alone) {
  constexpr gid_t kOurs = 4711;
  const std::vector<gid_t> member = {100, kOurs, 200}, other = {100, 200};
  EXPECT_TRUE(may_connect(0, {}, std::nullopt));
  EXPECT_TRUE(may_connect(geteuid(), other, std::nullopt));
  EXPECT_TRUE(may_connect(kNobody, member, kOurs));
  EXPECT_FALSE(may_connect(kNobody, other, kOurs));
  EXPECT_FALSE(may_connect(kNobody, member, std::nullopt));
  EXPECT_FALSE(may_connect(kNobody, {}, kOurs));
}

/// First answer to a process of another user, or nothing.
std::string told_to(uid_t user, const std::vector<gid_t>& groups, const std::filesystem::path& socket,
                    const std::function<void()>& serve) {
  std::array<int, 2> ends{};
  EXPECT_EQ(pipe(ends.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    if (setgroups(groups.size(), groups.data()) != 0 || setgid(user) != 0 || setuid(user) != 0) _exit(1);
    ControlClient client(socket);
    client.send(1, "Stop");
    for (int i = 0; i < 500; ++i) {
      usleep(10'000);
      for (const auto& answer : client.answers()) {
        (void)!write(ends[1], answer.error.data(), answer.error.size());
        _exit(0);
      }
    }
    _exit(0);
  }
  close(ends[1]);
  while (waitpid(child, nullptr, WNOHANG) == 0) {
    serve();
    usleep(1000);
  }
  std::array<char, 200> text{};
  const ssize_t got = read(ends[0], text.data(), text.size());
  close(ends[0]);
  return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0))};
}

// The file's mode is opened for all: who calls is still asked.
TEST_F(Burst, of_a_user_outside_the_group_is_refused) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  std::filesystem::permissions(folder_, std::filesystem::perms::all);
  std::filesystem::permissions(folder_ / "control", std::filesystem::perms::all);
  EXPECT_EQ(told_to(kNobody, {}, folder_ / "control", [this] { step(); }),
            "org.odomcalib.Calibration.NotPermitted");
  EXPECT_FALSE(server_->take_stop());
  EXPECT_EQ(server_->counters().not_permitted, 1U);
}

// A group that a process has beside its first one, among more than fit into the first question.
TEST_F(Burst, of_a_user_with_the_group_as_one_of_many_is_served) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  const struct group* const ours = getgrnam("daemon");
  ASSERT_NE(ours, nullptr) << "a group of every Debian";
  server_.reset();
  server_.emplace(value_of(ControlServer::create(folder_ / "control", "daemon")));
  EXPECT_EQ(server_->warning(), "");
  std::filesystem::permissions(folder_, std::filesystem::perms::all);
  std::vector<gid_t> groups(200);
  std::iota(groups.begin(), groups.end(), gid_t{70'000});
  groups.back() = ours->gr_gid;
  const auto serve = [this] {
    step();
    while (const auto call = server_->next_call()) server_->reply(call->client, control::encode_reply("{}"));
  };
  EXPECT_EQ(told_to(kNobody, groups, folder_ / "control", serve), "");
  EXPECT_EQ(server_->counters().not_permitted, 0U);
  EXPECT_EQ(server_->counters().served, 1U);
  EXPECT_TRUE(server_->take_stop());
}

TEST(ControlSocket, whose_group_is_missing_or_cannot_be_set_says_so_with_a_remedy) {
  TemporaryFolder folder;
  const auto without = value_of(ControlServer::create(folder / "a", "nobody-has-this-group"));
  EXPECT_NE(without.warning().find("there is no group \"nobody-has-this-group\""), std::string::npos);
  if (geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  const pid_t child = fork();
  if (child == 0) {
    if (setgroups(0, nullptr) != 0 || setgid(kNobody) != 0 || setuid(kNobody) != 0) _exit(1);
    const auto server = ControlServer::create(folder / "b", "daemon");
    const bool told = server.ok() && server.value().warning().find("Group=daemon") != std::string::npos;
    _exit(told ? 7 : 8);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

TEST_F(Burst, of_more_than_eight_clients_is_for_a_stop_alone) {
  std::vector<std::unique_ptr<ControlClient>> all;
  all.reserve(9);
  for (int i = 0; i < 9; ++i) all.push_back(client());
  all.back()->send(1, "GetStatus");
  EXPECT_TRUE(turn().empty());
  step();
  const auto refused = all.back()->answers();
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0].error, "org.odomcalib.Calibration.Refused");
  all.back()->send(1, "Stop");
  EXPECT_EQ(turn().size(), 1U);
  all[7]->send(1, "GetStatus");
  EXPECT_EQ(turn(), (std::vector<std::string>{"GetStatus8"}));
}

}  // namespace
}  // namespace odomcalib::control_server_test
