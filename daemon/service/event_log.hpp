// Where the events of the service go besides clients, recordings and LCM: the journal of the machine.
#pragma once

#include <functional>
#include <string>

#include "proto/wire/messages.hpp"

namespace odomcalib {

/// @param code what kind of event it is: a word
using EventLog =
    std::function<void(messages::Severity severity, const std::string& code, const std::string& text)>;

}  // namespace odomcalib
