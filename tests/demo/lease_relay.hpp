// Between clients that live in real time and a service whose time runs faster: bytes pass both ways, and the
// lease is renewed in the service's time for as long as its client renews it in real time.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "proto/control/control.hpp"
#include "proto/result.hpp"

namespace odomcalib::demo {

class LeaseRelay {
 public:
  /// Listens at `front` for clients of the service at `back`. Error: io.
  static Result<std::unique_ptr<LeaseRelay>> create(const std::filesystem::path& front,
                                                    std::filesystem::path back);
  ~LeaseRelay();
  LeaseRelay(const LeaseRelay&) = delete;
  LeaseRelay& operator=(const LeaseRelay&) = delete;

  /// Moves what has arrived, without waiting.
  /// @param real_now, service_now s on either clock
  void serve(double real_now, double service_now);
  /// The service is gone, and every client with it.
  void drop_all();
  /// A client holds the lease and renews it: something may move.
  [[nodiscard]] bool leased() const;

 private:
  /// One client and its connection to the service.
  struct Pair {
    int client = -1, service = -1;
    std::string to_client, to_service;  ///< not sent yet
    control::FrameDecoder calls, replies;
    std::string lease;       ///< that this client acquired; empty: none
    double renewed = 0.0;    ///< by the client, s of real time
    double passed_on = 0.0;  ///< by us, s of the service's time
    bool over = false;
  };

  LeaseRelay(int listener, std::filesystem::path back) : listener_(listener), back_(std::move(back)) {}
  void accept_clients();
  static void read_calls(Pair& pair, double real_now);
  static void read_replies(Pair& pair);
  static void renew(Pair& pair, double real_now, double service_now);

  int listener_;
  std::filesystem::path back_;
  std::vector<Pair> pairs_;
};

}  // namespace odomcalib::demo
