// SPDX-License-Identifier: Apache-2.0
// Reports the tests of a CppUnit program to rtf while they run. rtf loads a library that does
// this into programs which link CppUnit dynamically. Other programs add it to their main():
//
//     CppUnit::TextUi::TestRunner runner;
//     rtf::report_cases(runner.eventManager()); // or the CppUnit::TestResult that runs the tests
//
// It does nothing if rtf did not start the program. C++11; CppUnit 1.12 or later.
#ifndef RTF_CPPUNIT_HPP
#define RTF_CPPUNIT_HPP

#include <cppunit/TestResult.h>

#include <rtf/internal/CppUnitReporter.hpp>
#include <rtf/internal/SessionChannel.hpp>

namespace rtf {

// Reports the tests that `result` runs.
inline void report_cases(CppUnit::TestResult &result)
{
    using namespace internal::session;
    const auto reports_already =
        loaded_function<int (*)(const CppUnit::TestResult *)>("rtf_cppunit_reports");
    const bool is_reported = reports_already != nullptr && reports_already(&result) != 0;
    if (!is_reported && is_open()) {
        CppUnitReporter::instance().attach_to(result);
    }
}

} // namespace rtf

#endif
