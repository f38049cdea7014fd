#include "daemon/cli/live/page_server.hpp"
#include "daemon/cli/settings.hpp"

#include <fmt/format.h>
#include <httplib.h>
#include <openssl/evp.h>
#include <sys/socket.h>

#include <array>
#include <semaphore>
#include <thread>

namespace odomcalib::cli {
namespace {

constexpr const char* kLoopback = "127.0.0.1";

/// The library's pool takes any number of connections. Here those beyond the bound stay with the kernel,
/// which holds a handful and lets the rest wait; each that was taken ends within its time.
class BoundedPool final : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> job) override {
    free_.acquire();
    pool_.enqueue([this, job = std::move(job)] {
      job();
      free_.release();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  std::counting_semaphore<settings::kMostConnections> free_{settings::kMostConnections};
  httplib::ThreadPool pool_{settings::kThreads};
};

std::string text_between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin);
  if (from == std::string::npos) return "";
  const std::size_t to = text.find(end, from);
  return text.substr(from + begin.size(), to - from - begin.size());
}

/// Hash by which a Content-Security-Policy names an inline text.
std::string source_hash(const std::string& text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(), nullptr);
  std::array<unsigned char, std::size_t{2} * EVP_MAX_MD_SIZE> base64{};
  const int length = EVP_EncodeBlock(base64.data(), digest.data(), static_cast<int>(size));
  return "'sha256-" + std::string(base64.begin(), base64.begin() + length) + "'";
}

/// Nothing but the page's own style and script, and its data from where it came.
std::string policy_of(const std::string& page) {
  return fmt::format(
      "default-src 'none'; style-src {}; script-src {}; connect-src 'self'; img-src data:; base-uri 'none'; "
      "form-action 'none'; frame-ancestors 'none'",
      source_hash(text_between(page, "<style>", "</style>")),
      source_hash(text_between(page, "<script>", "</script>")));
}

void refuse(httplib::Response& response, int status, const char* why) {
  response.status = status;
  response.set_content(std::string(why) + "\n", "text/plain");
}

/// Before anything else of a request is looked at.
httplib::Server::HandlerResponse gate(const httplib::Request& request, httplib::Response& response) {
  using Outcome = httplib::Server::HandlerResponse;
  if (request.get_header_value_count("Host") != 1 || !is_own_host(request.get_header_value("Host"))) {
    refuse(response, 403, "this page is for this machine: open it as 127.0.0.1 or localhost");
    return Outcome::Handled;
  }
  if (request.method != "GET") {
    response.set_header("Allow", "GET");
    refuse(response, 405, "this page is for looking only");
    return Outcome::Handled;
  }
  return Outcome::Unhandled;
}

// Without SO_REUSEPORT, which the library sets: two views on one port would take turns.
void reuse_after_end(int fd) {
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
}

class LoopbackServer final : public PageServer {
 public:
  LoopbackServer(const std::string& page, const std::function<std::string()>& state) {
    server_.new_task_queue = [] { return new BoundedPool; };  // NOLINT: the library deletes it
    server_.set_socket_options(reuse_after_end);
    server_.set_keep_alive_max_count(1);  // a body that nobody read is not the next request
    server_.set_read_timeout(settings::kConnectionPatience_s);
    server_.set_write_timeout(settings::kConnectionPatience_s);
    server_.set_payload_max_length(0);
    server_.set_default_headers({{"Content-Security-Policy", policy_of(page)},
                                 {"X-Content-Type-Options", "nosniff"},
                                 {"Referrer-Policy", "no-referrer"},
                                 {"Cross-Origin-Resource-Policy", "same-origin"},
                                 {"Cache-Control", "no-store"}});
    server_.set_pre_routing_handler(gate);
    server_.Get("/", [page](const httplib::Request&, httplib::Response& response) {
      response.set_content(page, "text/html; charset=utf-8");
    });
    server_.Get("/state.json", [state](const httplib::Request&, httplib::Response& response) {
      response.set_content(state(), "application/json");
    });
  }
  ~LoopbackServer() override {
    server_.stop();
    if (thread_.joinable()) thread_.join();
  }
  LoopbackServer(const LoopbackServer&) = delete;
  LoopbackServer& operator=(const LoopbackServer&) = delete;

  bool start(int port) {
    if (port == 0)
      port_ = server_.bind_to_any_port(kLoopback);
    else
      port_ = server_.bind_to_port(kLoopback, port) ? port : -1;
    if (port_ <= 0) return false;
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::yield();  // or stop() would come before the start
    return true;
  }
  [[nodiscard]] int port() const override { return port_; }

 private:
  httplib::Server server_;
  std::thread thread_;
  int port_ = -1;
};

}  // namespace

bool is_own_host(const std::string& host) {
  const std::size_t colon = host.find(':');
  const std::string name = host.substr(0, colon);
  const bool has_port =
      colon == std::string::npos ||
      (colon + 1 < host.size() && host.find_first_not_of("0123456789", colon + 1) == std::string::npos);
  return has_port && (name == kLoopback || name == "localhost");
}

Result<std::unique_ptr<PageServer>> PageServer::open(int port, const std::string& page,
                                                     const std::function<std::string()>& state) {
  auto server = std::make_unique<LoopbackServer>(page, state);
  if (!server->start(port))
    return Error{ErrorCode::io, "the port cannot be opened, another program may have it",
                 fmt::format("{}:{}", kLoopback, port), "--port with another one, or 0 for any that is free"};
  return std::unique_ptr<PageServer>(std::move(server));
}

}  // namespace odomcalib::cli
