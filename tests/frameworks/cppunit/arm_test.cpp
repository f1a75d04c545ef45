// Tests of an arm, as a user of CppUnit writes them.
#include <cstdlib>
#include <functional>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <cppunit/TestCaller.h>
#include <cppunit/extensions/ExceptionTestCaseDecorator.h>
#include <cppunit/extensions/HelperMacros.h>
#include <cppunit/extensions/RepeatedTest.h>
#include <cppunit/extensions/TestFactoryRegistry.h>
#include <cppunit/ui/text/TestRunner.h>

class Arm : public CppUnit::TestFixture
{
    CPPUNIT_TEST_SUITE(Arm);
    CPPUNIT_TEST(passes);
    CPPUNIT_TEST(fails);
    CPPUNIT_TEST(failsNear);
    CPPUNIT_TEST(failsWithMessage);
    CPPUNIT_TEST(failsAssertion);
    CPPUNIT_TEST(isForced);
    CPPUNIT_TEST(throws);
    CPPUNIT_TEST(throwsNothingKnown);
    CPPUNIT_TEST_EXCEPTION(mustThrow, std::logic_error);
    CPPUNIT_TEST_EXCEPTION(doesNotThrow, std::logic_error);
    CPPUNIT_TEST_FAIL(mustFail);
    CPPUNIT_TEST(prints);
    CPPUNIT_TEST_PARAMETERIZED(reaches, {1, 2});
    CPPUNIT_TEST(afterAll);
    CPPUNIT_TEST_SUITE_END();

public:
    void setUp() override { position_ = 41; }

    void passes() { CPPUNIT_ASSERT_EQUAL(41, position_); }

    void fails()
    {
        CPPUNIT_ASSERT_EQUAL(42, position_); // line: fails
    }

    void failsNear()
    {
        CPPUNIT_ASSERT_DOUBLES_EQUAL(0.5, 0.75, 0.1); // line: fails near
    }

    void failsWithMessage()
    {
        const std::string home = "\"left\" <home> & ü";
        CPPUNIT_ASSERT_EQUAL_MESSAGE("the arm\nstays", home, std::string("away")); // line: message
    }

    void failsAssertion()
    {
        CPPUNIT_ASSERT(position_ == 3); // line: assertion
    }

    void isForced()
    {
        CPPUNIT_FAIL("no path"); // line: forced
    }

    void throws() { throw std::runtime_error("no power, \"joint\" 3 ü \xff"); }

    void throwsNothingKnown() { throw 3; }

    void mustThrow() { throw std::logic_error("as expected"); }

    void doesNotThrow() {}

    void mustFail() { CPPUNIT_FAIL("as expected"); }

    void prints()
    {
        std::cout << "on stdout, no newline";
        std::cerr << "on stderr\n";
    }

    void reaches(int joint) { CPPUNIT_ASSERT_LESS(2, joint); } // line: reaches

    void afterAll() {}

private:
    int position_ = 0;
};

class SetUp : public CppUnit::TestFixture
{
    CPPUNIT_TEST_SUITE(SetUp);
    CPPUNIT_TEST(isNotRun);
    CPPUNIT_TEST_SUITE_END();

public:
    void setUp() override
    {
        CPPUNIT_FAIL("no gripper"); // line: set-up
    }

    void isNotRun() { std::abort(); }
};

class TearDown : public CppUnit::TestFixture
{
    CPPUNIT_TEST_SUITE(TearDown);
    CPPUNIT_TEST(fails);
    CPPUNIT_TEST_SUITE_END();

public:
    void tearDown() override { throw std::runtime_error("the brake is stuck"); }

    void fails()
    {
        CPPUNIT_FAIL("first the test"); // line: before tear-down
    }
};

namespace {

// Suites that are not registered.
CppUnit::Test *more()
{
    auto *suite = new CppUnit::TestSuite("more");
    const std::vector<std::string> names = {
        "a, \"b\" 'c' <d> & [e] {f} (g)", "with/slash and spaces", "ünïcödé 😀", "same", "same", "",
    };
    for (const std::string &name : names) {
        suite->addTest(new CppUnit::TestCaller<Arm>(name, &Arm::passes));
    }
    auto *twice = new CppUnit::TestSuite("twice");
    twice->addTest(new CppUnit::TestCaller<Arm>("first", &Arm::passes));
    twice->addTest(new CppUnit::TestCaller<Arm>("second", &Arm::passes));
    suite->addTest(new CppUnit::RepeatedTest(twice, 2));
    return suite;
}

} // namespace

CPPUNIT_TEST_SUITE_REGISTRATION(Arm);
CPPUNIT_TEST_SUITE_REGISTRATION(SetUp);
CPPUNIT_TEST_SUITE_REGISTRATION(TearDown);

int main(int argc, char **argv)
{
    CppUnit::TextUi::TestRunner runner;
    const std::string registry = argc > 1 ? argv[1] : "";
    if (registry != "more") {
        runner.addTest(CppUnit::TestFactoryRegistry::getRegistry().makeTest());
    }
    runner.addTest(more());
    return runner.run("", false, true, false) ? 0 : 1;
}
