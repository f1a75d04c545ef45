// 50 000 tests with long names, one of which crashes.
#include <gtest/gtest.h>

#include <csignal>
#include <string>

namespace {

class Many : public ::testing::Test
{
public:
    explicit Many(int number) : number_(number) {}

    void TestBody() override
    {
        if (number_ == 25000) {
            std::raise(SIGSEGV);
        }
    }

private:
    int number_;
};

} // namespace

int main(int argc, char **argv)
{
    ::testing::InitGoogleTest(&argc, argv);
    for (int number = 0; number < 50000; ++number) {
        const std::string name = "MovesToThePoseWithTheNumber" + std::to_string(number);
        ::testing::RegisterTest("Many", name.c_str(), nullptr, nullptr, __FILE__, __LINE__,
                                [number]() -> Many * { return new Many(number); });
    }
    return RUN_ALL_TESTS();
}
