#pragma once

#include "lockwind/result.h"

#include <cstdint>
#include <string>

namespace lockwind {

/// The first IPv4 address of a host name or of an address in dotted form, in dotted form.
Result<std::string> resolve_ipv4(const std::string& host);

/// The IPv4 address of the local interface that packets to `address` leave by.
Result<std::string> local_address_towards(const std::string& address);

/// Whether `name` is a network interface of this machine, or an IPv4 address of one.
bool is_local_interface(const std::string& name);

} // namespace lockwind
