// Do six values arrive, how often, and how quiet are they?
#include <rtf/rtf.hpp>
#include <yarp/os/BufferedPort.h>
#include <yarp/os/Network.h>
#include <yarp/os/Property.h>
#include <yarp/sig/Vector.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <string>

using namespace std::chrono_literals;

class StreamTest : public rtf::TestCase
{
public:
    // The bench: a connection to the port. What is wrong here is an error, not a failure.
    bool setup(int argc, char **argv) override
    {
        yarp::os::Property options;
        options.fromCommand(argc, argv);
        const std::string from = options.find("from").asString();
        return port_.open("/StreamTest/values:i") && yarp_.connect(from, port_.getName());
    }

    void run() override
    {
        const yarp::sig::Vector first = next();
        yarp::sig::Vector low = first;
        yarp::sig::Vector high = first;
        const auto started = std::chrono::steady_clock::now();
        for (int i = 0; i < samples; ++i) {
            const yarp::sig::Vector values = next();
            for (std::size_t j = 0; j < values.size(); ++j) {
                low[j] = std::min(low[j], values[j]);
                high[j] = std::max(high[j], values[j]);
            }
        }
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - started;
        measure("rate", samples / taken.count(), "Hz", 5.0, 60.0);
        for (std::size_t j = 0; j < first.size(); ++j) {
            RTF_CHECK_NEAR(first[j], static_cast<double>(j), 0.15, "value " + std::to_string(j));
            measure("noise " + std::to_string(j), high[j] - low[j], "", 0.0, 0.15);
        }
    }

    void tearDown() override
    {
        port_.interrupt();
        port_.close();
    }

private:
    static constexpr int samples = 50;

    // The next six values. Looked for again and again, so that the test can be stopped.
    yarp::sig::Vector next()
    {
        const yarp::sig::Vector *values = nullptr;
        RTF_REQUIRE_UNTIL((values = port_.read(false)) != nullptr, 5s, "values");
        RTF_REQUIRE(values->size() == 6, "six values arrive");
        return *values;
    }

    yarp::os::Network yarp_;
    yarp::os::BufferedPort<yarp::sig::Vector> port_;
};

RTF_PLUGIN(StreamTest);
