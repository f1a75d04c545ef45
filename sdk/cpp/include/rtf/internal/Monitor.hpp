// SPDX-License-Identifier: Apache-2.0
// Formulas over signals that judge a test.
#ifndef RTF_INTERNAL_MONITOR_HPP
#define RTF_INTERNAL_MONITOR_HPP

#include <cstddef>
#include <string_view>

#include <rtf/internal/Message.hpp>

namespace rtf {

// What the violation of a monitor means: a failure or an error, and whether it stops the test, or
// also the rest of the suite.
enum class Severity { fail, error, stop, critical };

namespace internal {

inline std::string_view to_string(Severity severity)
{
    switch (severity) {
    case Severity::error:
        return "error";
    case Severity::stop:
        return "stop";
    case Severity::critical:
        return "critical";
    case Severity::fail:
        break;
    }
    return "fail";
}

inline void monitor(Location here, std::string_view formula, std::string_view name,
                    Severity severity)
{
    const rtf_host &table = host_with(offsetof(rtf_host, monitor), here, "monitors");
    auto declared = message_at<rtf_monitor>(here);
    declared.formula = to_text(formula);
    declared.name = to_text(name);
    declared.severity = to_text(to_string(severity));
    table.monitor(table.context, &declared);
}

} // namespace internal
} // namespace rtf

#endif
