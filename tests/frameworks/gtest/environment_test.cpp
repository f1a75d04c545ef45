// The global environment fails: GoogleTest then runs no test.

#include <gtest/gtest.h>

class Bench : public testing::Environment
{
public:
    void SetUp() override
    {
        FAIL() << "no power"; // line: environment
    }
};

TEST(Arm, NeverRuns) {}

int main(int argc, char **argv)
{
    testing::InitGoogleTest(&argc, argv);
    testing::AddGlobalTestEnvironment(new Bench);
    return RUN_ALL_TESTS();
}
