// The rover's odometer: adds up the speed of the wheel, and tells the distance
// on `distance`, 50 times a second.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

int main(int argc, char **argv)
{
    ros::init(argc, argv, "odometer");
    ros::NodeHandle node;

    double speed = 0.0; // m/s
    double metres = 0.0;
    const auto heard = node.subscribe<std_msgs::Float64>(
        "speed", 10, [&speed](const std_msgs::Float64ConstPtr &message) { speed = message->data; });
    const ros::Publisher told = node.advertise<std_msgs::Float64>("distance", 10);

    ros::Rate rate(50.0);
    ros::Time last = ros::Time::now();
    while (ros::ok()) {
        ros::spinOnce();
        const ros::Time now = ros::Time::now();
        metres += speed * (now - last).toSec();
        last = now;
        std_msgs::Float64 message;
        message.data = metres;
        told.publish(message);
        rate.sleep();
    }
    return 0;
}
