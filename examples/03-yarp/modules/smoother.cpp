// A module that takes the noise out of what a sensor publishes.
#include <yarp/os/BufferedPort.h>
#include <yarp/os/Network.h>
#include <yarp/os/RFModule.h>
#include <yarp/os/ResourceFinder.h>
#include <yarp/sig/Vector.h>

#include <cstddef>
#include <iostream>
#include <string>

class Smoother : public yarp::os::RFModule
{
public:
    bool configure(yarp::os::ResourceFinder &options) override
    {
        const std::string name = options.check("name", yarp::os::Value("/smoother")).asString();
        keep_ = options.check("keep", yarp::os::Value(0.9)).asFloat64();
        std::cout << "smoothing, keeps " << keep_ << std::endl;
        return in_.open(name + "/values:i") && out_.open(name + "/values:o");
    }

    double getPeriod() override { return 0.0; }

    bool updateModule() override
    {
        const yarp::sig::Vector *values = in_.read();
        if (values == nullptr) {
            return true; // interrupted
        }
        if (smooth_.size() != values->size()) {
            smooth_ = *values;
        }
        for (std::size_t i = 0; i < smooth_.size(); ++i) {
            smooth_[i] = keep_ * smooth_[i] + (1.0 - keep_) * (*values)[i];
        }
        out_.prepare() = smooth_;
        out_.write();
        return true;
    }

    bool interruptModule() override
    {
        in_.interrupt();
        return true;
    }

    bool close() override
    {
        in_.close();
        out_.close();
        return true;
    }

private:
    yarp::os::BufferedPort<yarp::sig::Vector> in_;
    yarp::os::BufferedPort<yarp::sig::Vector> out_;
    yarp::sig::Vector smooth_;
    double keep_ = 0.9;
};

int main(int argc, char *argv[])
{
    yarp::os::Network yarp;
    yarp::os::ResourceFinder options;
    options.configure(argc, argv);
    Smoother smoother;
    return smoother.runModule(options);
}
