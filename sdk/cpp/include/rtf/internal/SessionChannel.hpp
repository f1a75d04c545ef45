// SPDX-License-Identifier: Apache-2.0
// The socket in RTF_SESSION, over which a program sends packets to its host and waits for
// the answer to each. C++11.
#ifndef RTF_INTERNAL_SESSIONCHANNEL_HPP
#define RTF_INTERNAL_SESSIONCHANNEL_HPP

#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

// Weak: before glibc 2.34, a program that does not link libdl does not have it.
#pragma weak dlsym

namespace rtf {
namespace internal {
namespace session {

// In bytes, see spec/frameworks.md.
constexpr std::size_t longest_packet = 64 * 1024;

class Channel
{
public:
    static Channel &instance()
    {
        static Channel channel;
        return channel;
    }

    // Whether a host listens to this process.
    bool is_open()
    {
        if (fd_ < 0) {
            return false;
        }
        if (is_forked()) {
            return is_connected();
        }
        const std::lock_guard<std::mutex> lock(mutex_);
        return is_connected();
    }

    // Sends a packet, and returns the answer; empty if no host listens.
    std::string exchange(const std::string &packet)
    {
        if (!is_open()) {
            return std::string();
        }
        if (is_forked()) {
            // The parent may wait for an answer at the same time.
            return send("{\"answer\":false," + packet.substr(1)) ? "0" : "";
        }
        const std::lock_guard<std::mutex> lock(mutex_);
        const std::string answer = send(packet) ? receive() : std::string();
        is_broken_ = answer.empty();
        return answer;
    }

    // Whether this process was forked without executing another program. Another thread may
    // have held the lock at that time, so the process does not use it.
    bool is_forked() const { return getpid() != owner_; }

    // Seconds since the program was loaded.
    double seconds() const
    {
        const std::chrono::duration<double> age = std::chrono::steady_clock::now() - start_;
        return age.count();
    }

private:
    Channel() : start_(std::chrono::steady_clock::now()), owner_(getpid()), fd_(descriptor()) {}

    // The number in `fd:N`, or in `FD:N`; -1 if there is none.
    static int descriptor()
    {
        const char *const variable = std::getenv("RTF_SESSION");
        if (variable == nullptr ||
            (std::strncmp(variable, "fd:", 3) != 0 && std::strncmp(variable, "FD:", 3) != 0)) {
            return -1;
        }
        char *end = nullptr;
        const long number = std::strtol(variable + 3, &end, 10);
        return end != variable + 3 && *end == '\0' && number >= 0 ? static_cast<int>(number) : -1;
    }

    bool is_connected()
    {
        if (fd_ < 0 || is_broken_) {
            return false;
        }
        if (!is_checked_) {
            is_checked_ = true;
            int type = 0;
            socklen_t size = sizeof type;
            char *const variable = std::getenv("RTF_SESSION");
            if (getsockopt(fd_, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_SEQPACKET) {
                // A program that another one started, which has taken the session, says nothing.
                if (variable != nullptr && variable[0] == 'f') {
                    std::fputs("rtf: the descriptor in RTF_SESSION is not open here: "
                               "results of this process are not reported\n",
                               stderr);
                }
                is_broken_ = true;
                return false;
            }
            fcntl(fd_, F_SETFD, FD_CLOEXEC);
            if (variable != nullptr && std::strncmp(variable, "fd:", 3) == 0) {
                // In place: other threads may read the environment.
                std::memcpy(variable, "FD", 2);
            }
        }
        return true;
    }

    bool send(const std::string &packet) const
    {
        ssize_t sent = 0;
        do {
            sent = ::send(fd_, packet.data(), packet.size(), MSG_NOSIGNAL);
        } while (sent < 0 && errno == EINTR);
        return sent >= 0;
    }

    // Waits indefinitely: the test's limits apply.
    std::string receive() const
    {
        ssize_t size = 0;
        char first = 0;
        do {
            size = recv(fd_, &first, 1, MSG_PEEK | MSG_TRUNC);
        } while (size < 0 && errno == EINTR);
        if (size <= 0) {
            return std::string();
        }
        std::string answer(static_cast<std::size_t>(size), '\0');
        size = recv(fd_, &answer[0], answer.size(), 0);
        answer.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
        return answer;
    }

    std::mutex mutex_;
    const std::chrono::steady_clock::time_point start_;
    const pid_t owner_;
    const int fd_;
    bool is_checked_ = false;
    bool is_broken_ = false;
};

// Creates the channel before main(), so that `seconds` counts from there and a child that
// is forked later is recognised. The template makes it one object for all sources.
template <class Unused>
struct AtStart
{
    static const bool is_created;
};

template <class Unused>
const bool AtStart<Unused>::is_created = (Channel::instance(), true);

// A function that a library which was loaded before the program exports; null if there is
// none.
template <class Function>
Function loaded_function(const char *name)
{
    void *(*const find)(void *, const char *) = dlsym;
    void *const found = find == nullptr ? nullptr : find(RTLD_DEFAULT, name);
    Function function = nullptr;
    std::memcpy(&function, &found, sizeof function);
    return function;
}

// The channel of a reporter in such a library. The program uses that one, because the host
// expects one packet at a time. The answer is allocated with malloc.
using Exchange = char *(*)(const char *packet, std::size_t length, std::size_t *answer_length);

inline Exchange shared_exchange()
{
    static const Exchange exchange = loaded_function<Exchange>("rtf_session_exchange");
    return exchange;
}

inline bool is_open()
{
    static_cast<void>(&AtStart<void>::is_created);
    return Channel::instance().is_open();
}

// Sends a packet, and returns the answer; empty if no host listens.
inline std::string exchange(const std::string &packet)
{
    const Exchange shared = shared_exchange();
    if (shared == nullptr) {
        return Channel::instance().exchange(packet);
    }
    std::size_t length = 0;
    char *const answer = shared(packet.data(), packet.size(), &length);
    const std::string text(answer == nullptr ? "" : answer, length);
    std::free(answer);
    return text;
}

} // namespace session
} // namespace internal
} // namespace rtf

#endif
