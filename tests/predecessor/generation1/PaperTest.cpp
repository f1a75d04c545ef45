// A test as in the paper: one header, PREPARE macro before the class, no constructor.
#include <TestCase.h>

PREPARE_PLUGIN(PaperTest)

class PaperTest : public RTF::TestCase
{
public:
    virtual bool setup(int argc, char **argv)
    {
        RTF_TEST_REPORT(argv[0]);
        return argc == 2;
    }

    virtual void run()
    {
        RTF_TEST_CHECK(getName() == "PaperTest", "the name is the plug-in's");
        RTF_ASSERT_FAIL_IF(getParam() == "--well", "the arm is lost");
    }

    virtual void tearDown() { RTF_TEST_REPORT("parked"); }
};
