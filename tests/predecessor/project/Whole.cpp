// A test that overrides the order of its steps.
#include <cstdio>
#include <cstdlib>

#include <robottestingframework/TestAssert.h>
#include <robottestingframework/TestCase.h>
#include <robottestingframework/dll/Plugin.h>

class Whole : public robottestingframework::TestCase
{
public:
    Whole() : TestCase("Whole") {}

    void run(robottestingframework::TestResult &result) override
    {
        log("before");
        TestCase::run(result);
        log("after");
    }

    bool setup(int argc, char **) override
    {
        log("set up");
        return argc == 1;
    }

    void run() override
    {
        log("ran");
        ROBOTTESTINGFRAMEWORK_TEST_CHECK(getParam().empty(), "no parameters");
    }

    void tearDown() override { log("torn down"); }

private:
    static void log(const char *what)
    {
        if (FILE *file = std::fopen(std::getenv("BENCH_LOG"), "a")) {
            std::fprintf(file, "%s\n", what);
            std::fclose(file);
        }
    }
};

ROBOTTESTINGFRAMEWORK_PREPARE_PLUGIN(Whole)
