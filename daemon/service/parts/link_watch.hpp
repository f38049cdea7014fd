// News about the line to a device: found, lost, and why.
#pragma once

#include <optional>
#include <string>

#include "proto/result.hpp"

namespace odomcalib {

class LinkWatch {
 public:
  struct News {
    bool good = false;
    std::string text;
  };

  /// Changes since the last call: once for each thing that happens, not for each attempt to open the line
  /// again.
  /// @param device as configured
  std::optional<News> look(const std::string& device, bool connected, const std::optional<Error>& problem);

 private:
  bool connected_ = false;
  std::string problem_;
};

}  // namespace odomcalib
