// The methods of the control interface, each with its handler and what it requires.
#pragma once

#include "daemon/service/methods/method.hpp"

namespace odomcalib {

/// Answers the call or begins what it asks for. @return the task that it began, or null
std::unique_ptr<Task> handle_call(Context context, const IncomingCall& incoming);

/// Obeys a stop at once; the call is answered in its place.
void stop_robot(Context context);

// status_methods.cpp
Reading get_status(Context& context, const Call& call);
Reading describe(Context& context, const Call& call);
Reading check(Context& context, const Call& call);
Reading get_parameters(Context& context, const Call& call);
Reading get_history(Context& context, const Call& call);
Reading monitor(Context& context, const Call& call);

// lease_methods.cpp
Reading acquire(Context& context, const Call& call);
Reading renew(Context& context, const Call& call);
Reading release(Context& context, const Call& call);
Reading stop(Context& context, const Call& call);

// motion_methods.cpp
Reading nudge(Context& context, const Call& call);
Reading straight(Context& context, const Call& call);
Reading square(Context& context, const Call& call);
Reading spin(Context& context, const Call& call);
Reading calibrate(Context& context, const Call& call);
Reading record(Context& context, const Call& call);

// write_methods.cpp
Reading apply(Context& context, const Call& call);
Reading store(Context& context, const Call& call);
Reading discard(Context& context, const Call& call);
Reading set_parameters(Context& context, const Call& call);
Reading rollback(Context& context, const Call& call);

}  // namespace odomcalib
