// SPDX-License-Identifier: Apache-2.0
// Injects faults that the suite declares.
#ifndef RTF_INTERNAL_FAULTS_HPP
#define RTF_INTERNAL_FAULTS_HPP

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#ifdef __linux__
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#endif

#include <rtf/internal/Message.hpp>
#include <rtf/internal/Values.hpp>

namespace rtf {
namespace internal {

#ifdef __linux__
// A connection to the fixture `faults`.
class FaultConnection
{
public:
    explicit FaultConnection(std::string_view name)
        : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0))
    {
        // The first byte remains zero: the name is in the abstract namespace.
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        if (socket_ < 0 || name.size() + 1 > sizeof(address.sun_path)) {
            return;
        }
        std::memcpy(&address.sun_path[1], name.data(), name.size());
        const auto length = offsetof(sockaddr_un, sun_path) + 1 + name.size();
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the system's interface
        const auto *generic = reinterpret_cast<const sockaddr *>(&address);
        connected_ = ::connect(socket_, generic, static_cast<socklen_t>(length)) == 0;
    }
    FaultConnection(const FaultConnection &) = delete;
    FaultConnection &operator=(const FaultConnection &) = delete;
    ~FaultConnection()
    {
        if (socket_ >= 0) {
            ::close(socket_);
        }
    }

    bool connected() const { return connected_; }

    bool write(std::string_view text) const
    {
        while (!text.empty()) {
            const auto sent = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
            if (sent < 0 && errno != EINTR) {
                return false;
            }
            text.remove_prefix(sent < 0 ? 0 : static_cast<std::size_t>(sent));
        }
        return true;
    }

    // Reads to the end.
    bool read(std::string &text) const
    {
        char bytes[512];
        for (;;) {
            const auto received = ::recv(socket_, bytes, sizeof(bytes), 0);
            if (received > 0) {
                text.append(bytes, static_cast<std::size_t>(received));
            } else if (received == 0 || errno != EINTR) {
                return received == 0;
            }
        }
    }

private:
    int socket_ = -1;
    bool connected_ = false;
};
#endif

// Returns the problem; empty when it is done.
inline std::string request_fault(Location here, std::string_view request)
{
    const NamedValues values = fixture_values(here);
    for (std::size_t index = 0; index < values.count; ++index) {
        if (from_text(values.first[index].name) != "faults.socket") {
            continue;
        }
#ifdef __linux__
        const FaultConnection connection(from_text(values.first[index].value));
        std::string problem;
        if (connection.connected() && connection.write(request) && connection.read(problem)) {
            return problem;
        }
        return std::string("the fixture `faults` does not answer: ") + std::strerror(errno);
#else
        static_cast<void>(request);
        return "faults need Linux";
#endif
    }
    return "the suite declares no `<fault>` without `at`";
}

inline void change_fault(Location here, const char *verb, std::string_view name, const char *failed)
{
    std::string request(verb);
    request += '\n';
    request.append(name);
    request += '\n' + from_text(host().name(host().context)) + '\n';
    const std::string problem = request_fault(here, request);
    if (!problem.empty()) {
        error(here, "the fault \"" + std::string(name) + "\" was not " + failed + ": " + problem);
    }
}

} // namespace internal

// A fault that the test has injected. It ends with the test at the latest, not with this object.
class Fault
{
public:
    // TestCase::fault does this.
    Fault(std::string name, Location here) : name_(std::move(name))
    {
        internal::change_fault(here, "inject", name_, "injected");
    }

    // Removes it. No effect if it has ended already.
    void remove(Location here = Location::current()) const
    {
        internal::change_fault(here, "remove", name_, "removed");
    }

private:
    std::string name_;
};

} // namespace rtf

#endif
