// Do the encoders of every part tell plausible angles: as many as there are joints,
// numbers, and within the joints' limits?
#include <rtf/rtf.hpp>
#include <yarp/os/Bottle.h>
#include <yarp/os/BufferedPort.h>
#include <yarp/os/Network.h>
#include <yarp/os/Property.h>
#include <yarp/os/RpcClient.h>
#include <yarp/sig/Vector.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

using namespace std::chrono_literals;

class EncoderTest : public rtf::TestCase
{
public:
    // The bench: names of the parts, and a running YARP.
    bool setup(int argc, char **argv) override
    {
        yarp::os::Property options;
        options.fromCommand(argc, argv);
        robot_ = options.check("robot", yarp::os::Value("icubSim")).asString();
        const yarp::os::Bottle *parts = options.find("parts").asList();
        for (std::size_t i = 0; parts != nullptr && i < parts->size(); ++i) {
            parts_.push_back(parts->get(i).asString());
        }
        return !parts_.empty() && yarp_.checkNetwork(5.0);
    }

    void run() override
    {
        for (const std::string &part : parts_) {
            checkPart(part);
        }
    }

private:
    // Room for what the physics gives beyond a limit.
    static constexpr double slackDegrees = 2.0;

    void checkPart(const std::string &part)
    {
        const std::string prefix = "/" + robot_ + "/" + part;
        const yarp::os::Bottle names = ask(prefix, "get names");
        const yarp::os::Bottle limits = ask(prefix, "get limits");
        RTF_REQUIRE(names.size() > 0 && limits.size() == 2 * names.size(),
                    part + " tells its joints and their limits");
        const yarp::sig::Vector degrees = encoders(prefix);
        RTF_REQUIRE(degrees.size() == names.size(), part + " has an encoder for each of its " +
                                                        std::to_string(names.size()) + " joints");
        for (std::size_t i = 0; i < degrees.size(); ++i) {
            const double low = limits.get(2 * i).asFloat64() - slackDegrees;
            const double high = limits.get(2 * i + 1).asFloat64() + slackDegrees;
            measure(names.get(i).asString(), degrees[i], "deg", low, high);
        }
    }

    static yarp::os::Bottle ask(const std::string &prefix, const std::string &question)
    {
        yarp::os::RpcClient client;
        RTF_REQUIRE(client.open("/EncoderTest/rpc:o"), "a port of our own");
        RTF_REQUIRE(client.addOutput(prefix + "/rpc:i"), prefix + "/rpc:i can be reached");
        yarp::os::Bottle answer;
        RTF_REQUIRE(client.write(yarp::os::Bottle(question), answer), prefix + "/rpc:i answers");
        client.close();
        return answer;
    }

    static yarp::sig::Vector encoders(const std::string &prefix)
    {
        yarp::os::BufferedPort<yarp::sig::Vector> port;
        RTF_REQUIRE(port.open("/EncoderTest/state:i"), "a port of our own");
        RTF_REQUIRE(yarp::os::Network::connect(prefix + "/state:o", port.getName()),
                    prefix + "/state:o can be reached");
        const yarp::sig::Vector *values = nullptr;
        RTF_REQUIRE_UNTIL((values = port.read(false)) != nullptr, 5s, "encoders of " + prefix);
        yarp::sig::Vector degrees = *values;
        port.close();
        return degrees;
    }

    yarp::os::Network yarp_;
    std::string robot_;
    std::vector<std::string> parts_;
};

RTF_PLUGIN(EncoderTest)
