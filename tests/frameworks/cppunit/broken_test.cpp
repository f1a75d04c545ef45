// Tests that end the program, or hang.
#include <csignal>
#include <cstdlib>
#include <iostream>

#include <unistd.h>

#include <cppunit/BriefTestProgressListener.h>
#include <cppunit/CompilerOutputter.h>
#include <cppunit/TestResult.h>
#include <cppunit/TestResultCollector.h>
#include <cppunit/TestRunner.h>
#include <cppunit/extensions/HelperMacros.h>
#include <cppunit/extensions/TestFactoryRegistry.h>

class Broken : public CppUnit::TestFixture
{
    CPPUNIT_TEST_SUITE(Broken);
    CPPUNIT_TEST(passes);
    CPPUNIT_TEST(crashes);
    CPPUNIT_TEST(fails);
    CPPUNIT_TEST(hangs);
    CPPUNIT_TEST(exits);
    CPPUNIT_TEST(afterAll);
    CPPUNIT_TEST_SUITE_END();

public:
    void setUp() override { std::cout << "set up" << std::endl; }

    void passes() {}

    void crashes()
    {
        std::cout << "before the crash\n"; // not flushed
        std::raise(SIGSEGV);
    }

    void fails()
    {
        CPPUNIT_FAIL("after the crash"); // line: fails
    }

    void hangs()
    {
        for (;;) {
            pause();
        }
    }

    void exits() { std::exit(0); }

    void afterAll() {}
};

CPPUNIT_TEST_SUITE_REGISTRATION(Broken);

int main()
{
    CppUnit::TestResult result;
    CppUnit::TestResultCollector collector;
    CppUnit::BriefTestProgressListener progress;
    result.addListener(&collector);
    result.addListener(&progress);
    CppUnit::TestRunner runner;
    runner.addTest(CppUnit::TestFactoryRegistry::getRegistry().makeTest());
    runner.run(result);
    CppUnit::CompilerOutputter(&collector, std::cerr).write();
    return collector.wasSuccessful() ? 0 : 1;
}
