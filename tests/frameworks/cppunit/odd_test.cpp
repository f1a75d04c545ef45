// Runs tests in unusual ways, which its argument names.
#include <cstdlib>
#include <cstring>
#include <string>

#include <sys/socket.h>
#include <unistd.h>

#include <cppunit/TestCaller.h>
#include <cppunit/TestResult.h>
#include <cppunit/TestSuite.h>
#include <cppunit/extensions/HelperMacros.h>
#include <cppunit/extensions/TestDecorator.h>
#include <cppunit/ui/text/TestRunner.h>

class Odd : public CppUnit::TestFixture
{
public:
    static CppUnit::TestSuite *suite()
    {
        auto *suite = new CppUnit::TestSuite("Odd");
        suite->addTest(new CppUnit::TestCaller<Odd>("Odd::first", &Odd::first));
        suite->addTest(new CppUnit::TestCaller<Odd>("Odd::second", &Odd::second));
        return suite;
    }

    void first() {}

    void leaves() { _exit(0); }

    void second() { CPPUNIT_FAIL("second"); } // line: second
};

// Runs only the first of its tests.
class Half : public CppUnit::TestSuite
{
public:
    void run(CppUnit::TestResult *result) override { getChildTestAt(0)->run(result); }
};

int main(int argc, char **argv)
{
    const std::string mode = argc > 1 ? argv[1] : "";
    CppUnit::TextUi::TestRunner runner;
    if (mode == "direct") {
        CppUnit::Test *const suite = Odd::suite();
        suite->run(&runner.eventManager());
        return 1;
    }
    if (mode == "twice") {
        CppUnit::TextUi::TestRunner other;
        other.addTest(Odd::suite());
        other.run("Odd::first");
        runner.addTest(Odd::suite());
        return runner.run() ? 0 : 1;
    }
    if (mode == "half") {
        auto *half = new Half();
        half->addTest(new CppUnit::TestCaller<Odd>("Odd::first", &Odd::first));
        half->addTest(new CppUnit::TestCaller<Odd>("Odd::second", &Odd::second));
        runner.addTest(half);
        return runner.run() ? 0 : 1;
    }
    if (mode == "garbage") {
        const int session = std::atoi(std::getenv("RTF_SESSION") + std::strlen("fd:"));
        send(session, "garbage", 7, 0);
    }
    if (mode == "exit") {
        runner.addTest(new CppUnit::TestCaller<Odd>("Odd::first", &Odd::first));
        runner.addTest(new CppUnit::TestCaller<Odd>("leaves", &Odd::leaves));
    }
    if (mode == "code") {
        runner.addTest(new CppUnit::TestCaller<Odd>("Odd::first", &Odd::first));
        runner.run();
        return 3;
    }
    if (mode == "nothing") {
        return runner.run() ? 0 : 1;
    }
    runner.addTest(Odd::suite());
    return runner.run() ? 0 : 1;
}
