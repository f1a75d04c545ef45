// A program that links CppUnit statically, reports with the header, and measures.
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>

#include <cppunit/TestCaller.h>
#include <cppunit/extensions/HelperMacros.h>
#include <cppunit/ui/text/TestRunner.h>

#include <rtf/cppunit.hpp>
#include <rtf/session.hpp>

class Header : public CppUnit::TestFixture
{
    CPPUNIT_TEST_SUITE(Header);
    CPPUNIT_TEST(measures);
    CPPUNIT_TEST(exceeds);
    CPPUNIT_TEST(attachesDirectory);
    CPPUNIT_TEST(samples);
    CPPUNIT_TEST(crashes);
    CPPUNIT_TEST(readsValues);
    CPPUNIT_TEST(readsUnknownValue);
    CPPUNIT_TEST_SUITE_END();

public:
    void measures()
    {
        CPPUNIT_ASSERT(rtf::measure("settling time", 0.5, "s", 0, 0.8));
        rtf::report("a text");
        CPPUNIT_ASSERT(rtf::attach("/proc/self/status", "status.txt", "text/plain"));
        const char *const deleted = "deleted.csv";
        std::ofstream(deleted) << "1,2\n";
        CPPUNIT_ASSERT(rtf::attach(deleted));
        std::remove(deleted);
    }

    void exceeds()
    {
        rtf::measure("effort", 3, "Nm", 0, 2.5); // line: exceeds
    }

    void attachesDirectory() { CPPUNIT_ASSERT(!rtf::attach("/proc")); }

    void samples()
    {
        std::thread other([] { rtf::sample("speed", 1, "m/s"); });
        other.join();
        CPPUNIT_ASSERT(rtf::sample("speed", {{0.5, 1}, {1, 2}}, "m/s", 0, 2));
    }

    void crashes() { *static_cast<volatile int *>(nullptr) = 1; }

    void readsValues()
    {
        CPPUNIT_ASSERT_EQUAL(std::string("40123"), rtf::fixture_value("arm.port"));
    }

    void readsUnknownValue()
    {
        CPPUNIT_ASSERT_EQUAL(std::string("none"), rtf::fixture_value("arm.speed", "none"));
    }
};

int main()
{
    CppUnit::TextUi::TestRunner runner;
    rtf::report_cases(runner.eventManager());
    runner.addTest(Header::suite());
    return runner.run() ? 0 : 1;
}
