// Does the rover come as far as its speed says? Drives for a while and compares
// the odometer with the speed that was asked for.
#include <rtf/rtf.hpp>

#include <ros/ros.h>
#include <std_msgs/Float64.h>

#include <chrono>
#include <memory>
#include <string>

using namespace std::chrono;

class DistanceTest : public rtf::TestCase
{
public:
    bool setup(int argc, char **argv) override
    {
        for (int i = 1; i + 1 < argc; i += 2) {
            const std::string name = argv[i];
            (name == "--speed"     ? speed_
             : name == "--seconds" ? seconds_
                                   : tolerance_) = std::stod(argv[i + 1]);
        }
        // The master is the suite's: ROS_MASTER_URI. Signals are rtf's affair.
        ros::init(ros::M_string(), "distance_test",
                  ros::init_options::NoSigintHandler | ros::init_options::AnonymousName);
        node_ = std::make_unique<ros::NodeHandle>();
        command_ = node_->advertise<std_msgs::Float64>("/rover/command", 1);
        distance_ = node_->subscribe<std_msgs::Float64>(
            "/rover/distance", 1, [this](const std_msgs::Float64ConstPtr &message) {
                metres_ = message->data;
                heard_ = true;
            });
        wait_until([this] { return spin() && heard_ && command_.getNumSubscribers() > 0; }, 10s,
                   "the rover hears and is heard");
        return true;
    }

    void run() override
    {
        const double before = metres_;
        const auto started = steady_clock::now();
        drive(speed_);
        while (elapsed(started) < seconds_ && !interrupted()) {
            sleep(20ms);
            spin();
        }
        const double expected = speed_ * elapsed(started);
        const double driven = metres_ - before;
        measure("distance", driven, "m");
        RTF_CHECK_NEAR(driven, expected, tolerance_ * expected, "metres driven");
    }

    void tearDown() override
    {
        if (command_) {
            drive(0.0);
            sleep(100ms); // until it is sent
        }
    }

private:
    static double elapsed(steady_clock::time_point since)
    {
        return duration<double>(steady_clock::now() - since).count();
    }

    static bool spin()
    {
        ros::spinOnce();
        return true;
    }

    void drive(double speed)
    {
        std_msgs::Float64 message;
        message.data = speed;
        command_.publish(message);
    }

    double speed_ = 0.5; // m/s
    double seconds_ = 2.0;
    double tolerance_ = 0.25; // part of the distance; the command takes a moment
    double metres_ = 0.0;
    bool heard_ = false;
    std::unique_ptr<ros::NodeHandle> node_;
    ros::Publisher command_;
    ros::Subscriber distance_;
};

RTF_PLUGIN(DistanceTest);
