// A project that uses an installed rtf.
#include <rtf/rtf.hpp>

#include <cmath>
#include <string>

class CppTest : public rtf::TestCase
{
public:
    bool setup(int argc, char **argv) override
    {
        return argc == 3 && std::string(argv[1]) == "--angle";
    }

    void run() override
    {
        RTF_REPORT("environment: " + environment());
        RTF_CHECK(environment() == "--robot simulator", "the suite's environment arrives");
        RTF_CHECK_NEAR(std::cos(std::acos(0.5)), 0.5, 1e-12, "cosine and back");
        measure("cosine", std::cos(0.0), "", 0.5, 1.5);
    }

    void tearDown() override {}
};

RTF_PLUGIN(CppTest);
