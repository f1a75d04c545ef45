// SPDX-License-Identifier: Apache-2.0
// A fixture that reports a collapse from another thread, after which its check fails.
#include <atomic>
#include <thread>

#include <rtf/FixtureManager.hpp>

class Fixture : public rtf::FixtureManager
{
public:
    bool setup(int argc, char **) override
    {
        if (argc > 1) {
            watcher_ = std::thread([this] {
                well_ = false;
                getDispatcher()->fixtureCollapsed("the motor is too hot");
            });
        }
        return true;
    }

    bool check() override { return well_; }

    void tearDown() override
    {
        if (watcher_.joinable()) {
            watcher_.join();
        }
        report("torn down");
    }

private:
    std::atomic<bool> well_{true};
    std::thread watcher_;
};

RTF_PLUGIN(Fixture);
