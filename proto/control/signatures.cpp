#include "proto/control/signatures.hpp"

#include <regex>

namespace odomcalib::control {

std::vector<std::string> parameters_of(std::string_view method, std::string_view interface) {
  const std::string head = "\nmethod " + std::string(method) + "(";
  const std::size_t begin = interface.find(head);
  if (begin == std::string_view::npos) return {};
  const std::string parameters(
      interface.substr(begin + head.size(), interface.find(')', begin) - begin - head.size()));
  static const std::regex kName(R"((\w+)\s*:)");
  std::vector<std::string> names;
  for (std::sregex_iterator it(parameters.begin(), parameters.end(), kName), end; it != end; ++it)
    names.push_back((*it)[1].str());
  return names;
}

}  // namespace odomcalib::control
