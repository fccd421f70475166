#pragma once

#include <span>
#include <string>

#include "eval/gates.h"

namespace windhover {

/// The content of junit.xml: a test case that fails for `invalid_reason` unless that is empty, and
/// one for each gate.
std::string JunitXml(const std::string& suite, const std::string& validity_case,
                     const std::string& invalid_reason, std::span<const GateResult> gates);

}  // namespace windhover
