// Has other tests when it runs than when it lists them.

#include <gtest/gtest.h>

#include <string>

int main(int argc, char **argv)
{
    bool lists = false;
    for (int i = 1; i < argc; ++i) {
        lists = lists || std::string(argv[i]).rfind("--gtest_list_tests", 0) == 0;
    }
    class Empty : public testing::Test
    {
        void TestBody() override {}
    };
    auto make = [] { return static_cast<testing::Test *>(new Empty); };
    testing::RegisterTest("Arm", "Stays", nullptr, nullptr, __FILE__, __LINE__, make);
    testing::RegisterTest("Arm", lists ? "Listed" : "Unlisted", nullptr, nullptr, __FILE__,
                          __LINE__, make);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
