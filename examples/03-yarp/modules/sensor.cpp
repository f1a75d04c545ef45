// A module that publishes six values, as a force/torque sensor does, 50 times a second.
#include <yarp/os/BufferedPort.h>
#include <yarp/os/Network.h>
#include <yarp/os/RFModule.h>
#include <yarp/os/ResourceFinder.h>
#include <yarp/sig/Vector.h>

#include <cmath>
#include <cstddef>
#include <string>

class Sensor : public yarp::os::RFModule
{
public:
    bool configure(yarp::os::ResourceFinder &options) override
    {
        return port_.open(options.check("name", yarp::os::Value("/sensor")).asString() +
                          "/values:o");
    }

    double getPeriod() override { return 0.02; }

    bool updateModule() override
    {
        yarp::sig::Vector &values = port_.prepare();
        values.resize(6);
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = static_cast<double>(i) + 0.1 * std::sin(0.3 * steps_);
        }
        ++steps_;
        port_.write();
        return true;
    }

    bool interruptModule() override
    {
        port_.interrupt();
        return true;
    }

    bool close() override
    {
        port_.close();
        return true;
    }

private:
    yarp::os::BufferedPort<yarp::sig::Vector> port_;
    double steps_ = 0;
};

int main(int argc, char *argv[])
{
    yarp::os::Network yarp;
    yarp::os::ResourceFinder options;
    options.configure(argc, argv);
    Sensor sensor;
    return sensor.runModule(options);
}
