// Does the arm go where it is sent? Moves all joints through some poses, waits
// until they stand still, and checks how far from the pose they are.
#include <rtf/rtf.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ArmClient.hpp"

using namespace std::chrono_literals;

using Pose = std::vector<double>; // radians, one per joint

class AccuracyTest : public rtf::TestCase
{
public:
    // The bench: a connection to the arm. An exception here is an error, not a failure.
    bool setup(int argc, char **argv) override
    {
        for (int i = 1; i + 1 < argc; i += 2) {
            if (std::string(argv[i]) == "--tolerance") {
                tolerance_ = std::stod(argv[i + 1]);
            }
        }
        arm_ = std::make_unique<ArmClient>();
        joints_ = arm_->joints();
        RTF_REPORT(std::to_string(joints_.size()) + " joints; parameters: " + param());
        return joints_.size() == 3;
    }

    void run() override
    {
        double slowest = 0.0;
        double worst = 0.0;
        for (const Pose &target : {Pose{0.6, -0.5, 0.4}, Pose{-0.6, 0.5, -0.4}, Pose{0, 0, 0}}) {
            slowest = std::max(slowest, moveTo(target));
            const Pose reached = pose();
            RTF_CHECK_NEAR(reached, target, tolerance_, "pose of the arm");
            for (std::size_t i = 0; i < target.size(); ++i) {
                worst = std::max(worst, std::abs(reached[i] - target[i]));
            }
        }
        measure("worst error", worst, "rad", 0.0, tolerance_);
        measure("slowest move", slowest, "s", 0.0, 4.0);
    }

    // Called whatever happened above, so the arm is never left in a strange pose.
    void tearDown() override
    {
        if (arm_) {
            for (const std::string &joint : joints_) {
                arm_->move(joint, 0.0);
            }
        }
    }

private:
    // Moves all joints at once; the simulated seconds until the arm stands still there.
    double moveTo(const Pose &target)
    {
        for (std::size_t i = 0; i < joints_.size(); ++i) {
            arm_->move(joints_[i], target[i]);
        }
        const double started = arm_->time();
        RTF_REQUIRE_UNTIL(distance(pose(), target) < 0.1, 5s, "the arm near its pose");
        Sample before{started, Pose(target.size(), std::numeric_limits<double>::infinity())};
        RTF_REQUIRE_UNTIL(isAtRest(before), 5s, "the arm to stand still");
        return arm_->time() - started;
    }

    // Where the arm was, and when in the simulator's time.
    struct Sample
    {
        double time;
        Pose pose;
    };

    // Whether the arm has moved less than 0.1 mrad since `before`, which is replaced every
    // 50 ms of the simulator's time: on a busy machine a simulator that was not scheduled
    // looks like an arm at rest.
    bool isAtRest(Sample &before)
    {
        const double now = arm_->time();
        if (now - before.time < 0.05) {
            return false;
        }
        const Sample last = std::exchange(before, Sample{now, pose()});
        return distance(last.pose, before.pose) < 1e-4;
    }

    Pose pose()
    {
        Pose radians;
        for (const std::string &joint : joints_) {
            radians.push_back(arm_->position(joint));
        }
        return radians;
    }

    static double distance(const Pose &a, const Pose &b)
    {
        double largest = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            largest = std::max(largest, std::abs(a[i] - b[i]));
        }
        return largest;
    }

    double tolerance_ = 0.02;
    std::unique_ptr<ArmClient> arm_;
    std::vector<std::string> joints_;
};

RTF_PLUGIN(AccuracyTest);
