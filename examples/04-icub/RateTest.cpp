// Do the encoders arrive as often as they should, and evenly?
#include <rtf/rtf.hpp>
#include <yarp/os/BufferedPort.h>
#include <yarp/os/Network.h>
#include <yarp/os/Property.h>
#include <yarp/sig/Vector.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <vector>

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// Notes when values arrive, in YARP's own thread.
class Arrivals : public yarp::os::BufferedPort<yarp::sig::Vector>
{
public:
    explicit Arrivals(std::size_t wanted) : times_(wanted) {}

    bool complete() const { return count_ >= times_.size(); }

    // Milliseconds between two that follow each other; only once it is complete.
    std::vector<double> periods() const
    {
        std::vector<double> periods;
        for (std::size_t i = 1; i < times_.size(); ++i) {
            periods.push_back(
                std::chrono::duration<double, std::milli>(times_[i] - times_[i - 1]).count());
        }
        return periods;
    }

private:
    void onRead(yarp::sig::Vector & /*values*/) override
    {
        const std::size_t next = count_;
        if (next < times_.size()) {
            times_[next] = Clock::now();
            count_ = next + 1;
        }
    }

    std::vector<Clock::time_point> times_;
    std::atomic<std::size_t> count_{0};
};

class RateTest : public rtf::TestCase
{
public:
    bool setup(int argc, char **argv) override
    {
        yarp::os::Property options;
        options.fromCommand(argc, argv);
        rate_ = options.check("rate", yarp::os::Value(100.0)).asFloat64();
        tolerance_ = options.check("tolerance", yarp::os::Value(0.2)).asFloat64();
        arrivals_.setStrict(); // none may be left out
        arrivals_.useCallback();
        return arrivals_.open("/RateTest/state:i") &&
               yarp::os::Network::connect(options.find("from").asString(), arrivals_.getName());
    }

    void run() override
    {
        RTF_REQUIRE_UNTIL(arrivals_.complete(), 30s, "enough encoders");
        std::vector<double> periods = arrivals_.periods();
        double sum = 0.0;
        for (const double period : periods) {
            sum += period;
        }
        std::sort(periods.begin(), periods.end());
        measure("rate", 1000.0 * static_cast<double>(periods.size()) / sum, "Hz",
                (1.0 - tolerance_) * rate_, (1.0 + tolerance_) * rate_);
        measure("median period", periods[periods.size() / 2], "ms", 0.0, 2.0 * 1000.0 / rate_);
        measure("longest period", periods.back(), "ms");
    }

    void tearDown() override
    {
        arrivals_.disableCallback();
        arrivals_.interrupt();
        arrivals_.close();
    }

private:
    static constexpr std::size_t samples = 300;

    yarp::os::Network yarp_;
    Arrivals arrivals_{samples};
    double rate_ = 100.0;
    double tolerance_ = 0.2; // of the rate
};

RTF_PLUGIN(RateTest)
