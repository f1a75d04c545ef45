// The cases of tests/frameworks/promises.json.
#include <cstdlib>

#include <cppunit/extensions/HelperMacros.h>
#include <cppunit/extensions/TestFactoryRegistry.h>
#include <cppunit/ui/text/TestRunner.h>

#include <rtf/session.hpp>

class Promises : public CppUnit::TestFixture
{
    CPPUNIT_TEST_SUITE(Promises);
    CPPUNIT_TEST(first);
    CPPUNIT_TEST(second);
    CPPUNIT_TEST(third);
    CPPUNIT_TEST_SUITE_END();

public:
    void first() {}
    void second() { CPPUNIT_ASSERT_EQUAL(0, std::system(std::getenv("PROMISE"))); }
    void third()
    {
        if (const char *high = std::getenv("MEASURES")) {
            rtf::measure("force", 2.5, "N", 0, std::atof(high));
        }
    }
};

CPPUNIT_TEST_SUITE_REGISTRATION(Promises);

int main()
{
    CppUnit::TextUi::TestRunner runner;
    runner.addTest(CppUnit::TestFactoryRegistry::getRegistry().makeTest());
    return runner.run("", false, true, false) ? 0 : 1;
}
