// A test for a debugger.
#include <rtf/rtf.hpp>

class Reach : public rtf::TestCase
{
public:
    void run() override
    {
        volatile int angle = 42;
        RTF_CHECK(angle == 42, "the angle");
    }
};

RTF_PLUGIN(Reach)
