// Lists two tests as GoogleTest does, but runs none of them: `silent` ends with code 0, and
// `garbage` writes something else into the result stream.

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace {

std::string flag(int argc, char **argv, const std::string &name)
{
    for (int i = 1; i < argc; ++i) {
        if (std::string(argv[i]).rfind(name, 0) == 0) {
            return std::string(argv[i]).substr(name.size());
        }
    }
    return "";
}

bool has(int argc, char **argv, const char *argument)
{
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], argument) == 0) {
            return true;
        }
    }
    return false;
}

void sendGarbage(int port)
{
    const int stream = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(stream, reinterpret_cast<sockaddr *>(&address), sizeof address) == 0) {
        const char text[] = "gtest_streaming_protocol_version=1.0\nHello, arm.\n";
        (void)!write(stream, text, sizeof text - 1);
    }
    close(stream);
}

} // namespace

int main(int argc, char **argv)
{
    if (has(argc, argv, "--gtest_list_tests")) {
        std::ofstream(flag(argc, argv, "--gtest_output=json:"))
            << R"({"tests":2,"name":"AllTests","testsuites":[{"name":"Arm","tests":2,"testsuite":[)"
            << R"({"name":"Moves","file":"arm.cpp","line":3},{"name":"Stops","file":"arm.cpp","line":4}]}]})";
        std::puts("Arm.\n  Moves\n  Stops");
    } else if (has(argc, argv, "garbage")) {
        const std::string address = flag(argc, argv, "--gtest_stream_result_to=");
        sendGarbage(std::atoi(address.substr(address.rfind(':') + 1).c_str()));
    }
}
