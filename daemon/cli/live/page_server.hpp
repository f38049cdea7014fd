// A page and its data on loopback, for looking only.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "proto/result.hpp"

namespace odomcalib::cli {

/// Serves GET / and GET /state.json on 127.0.0.1 with threads of its own. Any other method is answered 405,
/// any other path 404, and a Host that is not this machine's own name 403: a page from elsewhere cannot read
/// this one under a name of its own. Connections beyond a bound wait.
class PageServer {
 public:
  /// @param port 0: any free one
  /// @param page a whole HTML document; its inline style and script are the only ones that a browser runs
  /// @param state makes the JSON document; called by the server's threads
  /// Errors: io (the port is taken).
  static Result<std::unique_ptr<PageServer>> open(int port, const std::string& page,
                                                  const std::function<std::string()>& state);
  /// Ends when requests that have begun are answered.
  virtual ~PageServer() = default;
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;
  [[nodiscard]] virtual int port() const = 0;

 protected:
  PageServer() = default;
};

/// Whether a Host header names this machine by its loopback name, with any port.
bool is_own_host(const std::string& host);

}  // namespace odomcalib::cli
