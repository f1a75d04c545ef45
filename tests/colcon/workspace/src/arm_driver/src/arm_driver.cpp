#include "arm_driver/arm_driver.hpp"

#include <arpa/inet.h>
#include <cmath>
#include <cstdlib>
#include <netinet/in.h>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

double ask_arm(int port, double angle)
{
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int arm = socket(AF_INET, SOCK_STREAM, 0);
    const std::string question = std::to_string(angle) + "\n";
    char answer[64] = {};
    const bool answered =
        connect(arm, reinterpret_cast<sockaddr *>(&address), sizeof address) == 0 &&
        write(arm, question.data(), question.size()) > 0 &&
        read(arm, answer, sizeof answer - 1) > 0;
    close(arm);
    return answered ? std::strtod(answer, nullptr) : std::nan("");
}
