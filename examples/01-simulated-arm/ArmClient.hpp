// Talks to the simulated arm over TCP, with nothing but POSIX sockets.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

// One connection to the simulator, on 127.0.0.1 and the port in ARM_PORT. Any
// problem is an exception: in a test that makes the verdict `error`, because the
// bench is wrong then and nothing is known about the robot.
class ArmClient
{
public:
    ArmClient() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0))
    {
        try {
            connect();
        } catch (...) {
            ::close(socket_);
            throw;
        }
    }

    ~ArmClient() { ::close(socket_); }

    ArmClient(const ArmClient &) = delete;
    ArmClient &operator=(const ArmClient &) = delete;

    // The names of the joints, from the base on.
    std::vector<std::string> joints()
    {
        std::istringstream words(ask("joints"));
        std::vector<std::string> names;
        for (std::string name; words >> name;) {
            names.push_back(name);
        }
        return names;
    }

    // What the joint's encoder says, in radians.
    double position(const std::string &joint) { return std::stod(ask("get " + joint)); }

    // The simulator's time, in seconds.
    double time() { return std::stod(ask("time")); }

    // Lets the joint begin to move to `target` radians.
    void move(const std::string &joint, double target)
    {
        ask("set " + joint + " " + std::to_string(target));
    }

private:
    // An arm that is slower hangs. The suite's <alive> notices that earlier, so
    // that a test does not take the blame.
    static constexpr timeval kAnswerTime{10, 0};

    void connect()
    {
        const char *port = std::getenv("ARM_PORT");
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(static_cast<std::uint16_t>(port ? std::stoi(port) : 17681));
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        const int on = 1;
        check(::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &kAnswerTime, sizeof kAnswerTime));
        check(::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on));
        check(::connect(socket_, reinterpret_cast<sockaddr *>(&address), sizeof address));
    }

    // Sends a line and returns what the arm answers after `ok`.
    std::string ask(const std::string &line)
    {
        const std::string request = line + "\n";
        for (std::size_t sent = 0; sent < request.size();) {
            sent +=
                check(::send(socket_, request.data() + sent, request.size() - sent, MSG_NOSIGNAL));
        }
        const std::string answer = readLine(line);
        if (answer.compare(0, 2, "ok") != 0) {
            throw std::runtime_error("`" + line + "`: " + answer);
        }
        return answer.size() > 3 ? answer.substr(3) : std::string();
    }

    std::string readLine(const std::string &request)
    {
        for (;;) {
            const std::size_t end = received_.find('\n');
            if (end != std::string::npos) {
                const std::string line = received_.substr(0, end);
                received_.erase(0, end + 1);
                return line;
            }
            char buffer[256];
            const std::size_t count = check(::recv(socket_, buffer, sizeof buffer, 0));
            if (count == 0) {
                throw std::runtime_error("the arm closed the connection at `" + request + "`");
            }
            received_.append(buffer, count);
        }
    }

    static std::size_t check(ssize_t result)
    {
        if (result < 0) {
            const int cause = errno == EAGAIN ? ETIMEDOUT : errno;
            throw std::system_error(cause, std::generic_category(), "connection to the arm");
        }
        return static_cast<std::size_t>(result);
    }

    int socket_;
    std::string received_;
};
