// SPDX-License-Identifier: Apache-2.0
// Injects faults that the suite declares.
#ifndef RTF_INTERNAL_FAULTS_HPP
#define RTF_INTERNAL_FAULTS_HPP

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include <rtf/internal/Message.hpp>

namespace rtf {
namespace internal {

// Injects or removes a fault. The host has reported a problem as an error, which ends the step.
inline void request_fault(Location here, std::int32_t action, std::string_view name)
{
    const rtf_host &table = host_with(offsetof(rtf_host, fault), here, "faults");
    if (table.fault(table.context, action, to_text(name), here.file, here.line) != RTF_DONE) {
        throw Stop();
    }
}

} // namespace internal

// A fault that the test has injected. It ends with the test at the latest, not with this object.
class Fault
{
public:
    // TestCase::fault does this.
    Fault(std::string name, Location here) : name_(std::move(name))
    {
        internal::request_fault(here, RTF_FAULT_INJECT, name_);
    }

    // Removes it. No effect if it has ended already.
    void remove(Location here = Location::current()) const
    {
        internal::request_fault(here, RTF_FAULT_REMOVE, name_);
    }

private:
    std::string name_;
};

} // namespace rtf

#endif
