// Runs a test with the web listener, prints its port, and exits when standard input closes.
#include <iostream>
#include <string>

#include <robottestingframework/TestAssert.h>
#include <robottestingframework/TestCase.h>
#include <robottestingframework/TestResult.h>
#include <robottestingframework/TestRunner.h>
#include <robottestingframework/TestSuite.h>
#include <robottestingframework/WebProgressListener.h>

using namespace robottestingframework;

class Quoted : public TestCase
{
public:
    Quoted() : TestCase("a \"quoted\" test") {}

    void run() override
    {
        ROBOTTESTINGFRAMEWORK_TEST_REPORT(std::string("</script> \\ \n \xFF \xC3\xA9 \0!", 21));
        ROBOTTESTINGFRAMEWORK_ASSERT_FAIL("it fails");
    }
};

int main()
{
    WebProgressListener web(0);
    TestResult result;
    result.addListener(&web);
    Quoted test;
    TestSuite suite("a 'suite'");
    suite.addTest(&test);
    TestRunner runner;
    runner.addTest(&suite);
    runner.run(result);
    std::cout << web.port() << std::endl;
    std::string line;
    std::getline(std::cin, line);
    return 0;
}
