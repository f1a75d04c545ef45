// SPDX-License-Identifier: Apache-2.0
// Cases and skipping.
#ifndef RTF_INTERNAL_CASES_HPP
#define RTF_INTERNAL_CASES_HPP

#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <rtf/internal/Exceptions.hpp>
#include <rtf/internal/Number.hpp>

namespace rtf {
namespace internal {

// A parameter of a case: its value is a number, a bool or a text.
struct CaseParameter
{
    template <class T>
    CaseParameter(std::string_view name_, const T &value_) : name(name_), value(last_value(value_))
    {
        static_assert(std::is_arithmetic_v<T> || std::is_convertible_v<const T &, std::string_view>,
                      "a parameter is a number, a bool or a text");
    }

    std::string_view name;
    std::string value;
};

// A case without its body, which `+` runs: see RTF_CASE.
class Case
{
public:
    Case(Location here, std::string_view name, std::initializer_list<CaseParameter> parameters = {})
        : here_(here), name_(name), parameters_(parameters)
    {
    }

    template <class Body>
    void operator+(Body &&body) const
    {
        const rtf_host &table = host_since_1_3(here_, "cases");
        if (!begin(table)) {
            return;
        }
        int32_t result = RTF_DONE;
        bool ends_test = false;
        try {
            body();
        } catch (...) {
            result = RTF_STOPPED;
            ends_test = report_exception();
        }
        table.case_end(table.context, result);
        if (ends_test) {
            throw Stop{true};
        }
    }

private:
    bool begin(const rtf_host &table) const
    {
        std::vector<rtf_parameter> parameters;
        for (const CaseParameter &parameter : parameters_) {
            parameters.push_back({to_text(parameter.name), to_text(parameter.value)});
        }
        auto message = message_at<rtf_case>(here_);
        message.name = to_text(name_);
        message.parameters = parameters.data();
        message.parameter_count = parameters.size();
        return table.case_begin(table.context, &message) != 0;
    }

    Location here_;
    std::string_view name_;
    std::vector<CaseParameter> parameters_;
};

[[noreturn]] inline void skip(Location here, std::string_view reason)
{
    const rtf_host &table = host_since_1_3(here, "cases");
    table.skip(table.context, to_text(reason));
    throw Stop();
}

inline void plan_cases(Location here, const std::vector<std::string> &names)
{
    std::vector<rtf_text> texts;
    texts.reserve(names.size());
    for (const std::string &name : names) {
        texts.push_back(to_text(name));
    }
    const rtf_host &table = host_since_1_3(here, "cases");
    table.plan_cases(table.context, texts.data(), texts.size());
}

} // namespace internal
} // namespace rtf

#endif
