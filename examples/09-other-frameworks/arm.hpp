// The arm of lesson 1, on the port that the fixture `arm` provides.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>

#include "ArmClient.hpp"

// ArmClient reads its port from ARM_PORT.
struct ArmPort
{
    ArmPort()
    {
        if (const char *port = std::getenv("RTF_FIXTURE_ARM_PORT")) {
            ::setenv("ARM_PORT", port, 1);
        }
    }
};

class Arm : private ArmPort, public ArmClient
{
public:
    // Moves a joint; whether it comes within 0.05 rad of the target in 5 s.
    bool reaches(const std::string &joint, double radians)
    {
        move(joint, radians);
        for (int tries = 0; tries < 500; ++tries) {
            if (std::abs(position(joint) - radians) < 0.05) {
                return true;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }
};
