// SPDX-License-Identifier: Apache-2.0
// Calls every function of the SDK for tests. The native host's tests compare the messages.
#include <array>
#include <chrono>
#include <limits>
#include <list>
#include <string>
#include <thread>
#include <vector>

#include <rtf/rtf.hpp>

namespace bench {

bool helper()
{
    return RTF_CHECK(true, "a helper function checks");
}

class EveryMacro : public rtf::TestCase
{
public:
    bool setup(int argc, char **argv) override
    {
        for (int index = 0; index < argc; ++index) {
            report("<" + std::string(argv[index]) + ">");
        }
        return RTF_CHECK(argv[argc] == nullptr, "argv ends with a null");
    }

    void run() override
    {
        report(name() + "|" + param() + "|" + environment() + "|" + std::to_string(repetition()));
        RTF_REPORT(std::string("zero \0 inside", 13));
        helper();
        RTF_REQUIRE((std::is_same_v<int, int>), std::string("commas are no trouble"));
        RTF_REQUIRE_CRITICAL(true, "safe");
        near();
        RTF_REQUIRE_UNTIL(++asked_ == 3, std::chrono::seconds(10), "the third question");
        RTF_CHECK(wait_until([] { return 7; }, std::chrono::seconds(0), "nothing"), "waited");
        sleep(std::chrono::milliseconds(1));
        RTF_CHECK(!interrupted(), "not asked to stop");
        RTF_CHECK(measure("rate", 100, "Hz", 95.0, 105.0), "within");
        RTF_CHECK(measure("free", 1), "without limits");
        std::thread([this] { report("from a thread"); }).join();
    }

private:
    void near()
    {
        const double nan = std::numeric_limits<double>::quiet_NaN();
        RTF_CHECK_NEAR(1.25, 1, 0.1, "gain");
        RTF_CHECK_NEAR((std::array<float, 3>{1, 2, 3.5F}), {1, 2, 3}, 0.1, "pose");
        const std::vector<std::vector<int>> rows{{1, 2}, {3, 9}};
        RTF_CHECK_NEAR(rows, (std::list<double>{1, 2, 3, 4}), 0.1, "matrix");
        RTF_CHECK_NEAR((std::vector<double>{1, 2}), {1, 2, 3}, 0.1, "lengths");
        RTF_CHECK_NEAR(nan, 1, 0.1, "lost");
        RTF_CHECK_NEAR((std::vector<double>{5, nan}), {0, 2}, 0.1, "lost in a vector");
        RTF_CHECK_ANGLE_NEAR(0, 1, 0.1, "yaw");
        RTF_CHECK_ANGLE_NEAR((std::vector<double>{0, 6.5}), {0, 0}, 0.1, "yaws");
        RTF_REQUIRE_NEAR(1, 1, 0, "exact");
        RTF_REQUIRE_ANGLE_NEAR(3.1, -3.1, 0.1, "heading");
    }

    int asked_ = 0;
};

} // namespace bench

RTF_PLUGIN(bench::EveryMacro);
