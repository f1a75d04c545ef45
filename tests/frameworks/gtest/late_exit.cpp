// All tests pass, and then the program fails.

#include <gtest/gtest.h>

#include <iostream>

TEST(Arm, Passes) {}

int main(int argc, char **argv)
{
    testing::InitGoogleTest(&argc, argv);
    const int code = RUN_ALL_TESTS();
    std::cout << "after all tests\n";
    return code == 0 ? 5 : code;
}
