// Cases that start processes, see tests/frameworks/descendants. With
// REPORTS_CASES, the program reports them itself, and needs no preloaded
// library.
#include <string>

#include <cppunit/TestCaller.h>
#include <cppunit/TestResult.h>
#include <cppunit/TestSuite.h>
#include <cppunit/extensions/HelperMacros.h>
#include <cppunit/ui/text/TestRunner.h>

#ifdef REPORTS_CASES
#include <rtf/cppunit.hpp>
#endif

#include "../descendants/descendants.hpp"

class Descendants : public CppUnit::TestFixture
{
public:
#define CASE(name)                                                                                 \
    void name()                                                                                    \
    {                                                                                              \
        CPPUNIT_ASSERT(descendants::holds(descendants::name));                                     \
    }
    DESCENDANTS(CASE)
#undef CASE
};

// Without an argument, all tests run.
int main(int argc, char **argv)
{
    const std::string only = argc > 1 ? argv[1] : "";
    CppUnit::TextUi::TestRunner runner;
#ifdef REPORTS_CASES
    rtf::report_cases(runner.eventManager());
#endif
#define CASE(name)                                                                                 \
    if (only.empty() || only == #name) {                                                           \
        runner.addTest(new CppUnit::TestCaller<Descendants>(#name, &Descendants::name));           \
    }
    DESCENDANTS(CASE)
    return runner.run("", false, true, false) ? 0 : 1;
}
