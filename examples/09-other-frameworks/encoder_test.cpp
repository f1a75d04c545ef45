// CppUnit: the encoders of the arm.
#include <cppunit/extensions/HelperMacros.h>
#include <cppunit/ui/text/TestRunner.h>

#include "arm.hpp"

class EncoderTest : public CppUnit::TestFixture
{
    CPPUNIT_TEST_SUITE(EncoderTest);
    CPPUNIT_TEST(followsTheElbow);
    CPPUNIT_TEST(isStillAtRest);
    CPPUNIT_TEST_SUITE_END();

public:
    void setUp() override { CPPUNIT_ASSERT(arm_.reaches("elbow", 0.0)); }

    void followsTheElbow()
    {
        CPPUNIT_ASSERT(arm_.reaches("elbow", 0.4));
        CPPUNIT_ASSERT_DOUBLES_EQUAL(0.4, arm_.position("elbow"), 0.05);
    }

    void isStillAtRest()
    {
        const double before = arm_.position("shoulder");
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        CPPUNIT_ASSERT_DOUBLES_EQUAL(before, arm_.position("shoulder"), 0.05);
    }

private:
    Arm arm_;
};

CPPUNIT_TEST_SUITE_REGISTRATION(EncoderTest);

int main()
{
    CppUnit::TextUi::TestRunner runner;
    runner.addTest(CppUnit::TestFactoryRegistry::getRegistry().makeTest());
    return runner.run() ? 0 : 1;
}
