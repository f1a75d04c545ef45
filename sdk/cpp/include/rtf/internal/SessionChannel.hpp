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
        // Checked first: after a fork, a lock that another thread held stays locked.
        if (fd_ < 0 || !is_own_process()) {
            return false;
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
        const std::lock_guard<std::mutex> lock(mutex_);
        const std::string answer = send(packet) ? receive() : std::string();
        is_broken_ = answer.empty();
        return answer;
    }

    // Seconds since the program was loaded.
    double seconds() const
    {
        const std::chrono::duration<double> age = std::chrono::steady_clock::now() - start_;
        return age.count();
    }

private:
    Channel() : start_(std::chrono::steady_clock::now()), owner_(getpid()), fd_(descriptor()) {}

    // The number in `fd:N`; -1 if there is none.
    static int descriptor()
    {
        const char *const variable = std::getenv("RTF_SESSION");
        if (variable == nullptr || std::strncmp(variable, "fd:", 3) != 0) {
            return -1;
        }
        char *end = nullptr;
        const long number = std::strtol(variable + 3, &end, 10);
        return end != variable + 3 && *end == '\0' && number >= 0 ? static_cast<int>(number) : -1;
    }

    // The host expects one packet at a time. A child that dies while it waits would leave its
    // answer to its parent.
    bool is_own_process()
    {
        if (getpid() == owner_) {
            return true;
        }
        if (!has_warned_) {
            has_warned_ = true;
            std::fputs("rtf: a forked process cannot report results\n", stderr);
        }
        return false;
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
            // A program that this one started has the variable, and may lack the descriptor.
            if (getsockopt(fd_, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_SEQPACKET) {
                std::fputs("rtf: the descriptor in RTF_SESSION is not open here: "
                           "results of this process are not reported\n",
                           stderr);
                is_broken_ = true;
                return false;
            }
            fcntl(fd_, F_SETFD, FD_CLOEXEC);
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
    bool has_warned_ = false;
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

// A reporter that was loaded before the program exports its channel under this name. The
// program uses that one, because the host expects one packet at a time. The answer is
// allocated with malloc.
using Exchange = char *(*)(const char *packet, std::size_t length, std::size_t *answer_length);

inline Exchange loaded_exchange()
{
    void *(*const find)(void *, const char *) = dlsym;
    void *const found = find == nullptr ? nullptr : find(RTLD_DEFAULT, "rtf_session_exchange");
    Exchange exchange = nullptr;
    std::memcpy(&exchange, &found, sizeof exchange);
    return exchange;
}

inline Exchange shared_exchange()
{
    static const Exchange exchange = loaded_exchange();
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
