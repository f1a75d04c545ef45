// A program without a framework, for CTest: `arm_command joints` prints the joints,
// `arm_command move JOINT RADIANS` moves one.
#include <iostream>

#include "arm.hpp"

int main(int argc, char **argv)
{
    try {
        Arm arm;
        const std::string verb = argc > 1 ? argv[1] : "";
        if (verb == "joints" && argc == 2) {
            for (const std::string &joint : arm.joints()) {
                std::cout << joint << '\n';
            }
            return 0;
        }
        if (verb == "move" && argc == 4) {
            return arm.reaches(argv[2], std::stod(argv[3])) ? 0 : 1;
        }
        std::cerr << "usage: arm_command joints | move JOINT RADIANS\n";
    } catch (const std::exception &problem) {
        std::cerr << "arm_command: " << problem.what() << '\n';
    }
    return 2;
}
