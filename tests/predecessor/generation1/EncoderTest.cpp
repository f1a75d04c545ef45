// A test for RTF 1.x.
#include <Plugin.h>
#include <TestAssert.h>
#include <TestCase.h>

#include <string>

class EncoderTest : public RTF::TestCase
{
public:
    EncoderTest() : TestCase("EncoderTest") {}

    virtual bool setup(int argc, char **argv)
    {
        RTF_TEST_REPORT("setting up");
        RTF_ASSERT_ERROR_IF(argc > 1, "tell how to end");
        how = argv[1];
        return how != "setup-false";
    }

    virtual void run()
    {
        RTF_TEST_CHECK(1 + 1 == 2, "arithmetic");
        RTF_ASSERT_ERROR_IF(how != "error-if", "an error unless the condition holds");
        RTF_ASSERT_FAIL_IF(how != "fail-if", "a failure unless the condition holds");
        RTF_TEST_FAIL_IF(how != "test-fail-if", "a failure unless the condition holds");
        if (how == "error") {
            RTF_ASSERT_ERROR("no encoder");
        } else if (how == "fail") {
            RTF_ASSERT_FAIL("the encoder is off");
        } else if (how == "check") {
            RTF_TEST_CHECK(getEnvironment() == "nowhere", "where it runs");
        }
    }

    virtual void tearDown() { RTF_TEST_REPORT(RTF::Asserter::format("%s is over", how.c_str())); }

    virtual void interrupt() { how = "stopped"; }

private:
    std::string how;
};

PREPARE_PLUGIN(EncoderTest)
