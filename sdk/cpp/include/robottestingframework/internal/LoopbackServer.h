// SPDX-License-Identifier: Apache-2.0
// A web server for one page on this machine: it listens on 127.0.0.1 only,
// answers GET, and closes each connection. It writes an answer in one call, with a short
// head: clients of robot-testing-framework 2.x read only once, and few bytes.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_LOOPBACKSERVER_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_LOOPBACKSERVER_H

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <thread>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace robottestingframework {
namespace internal {

struct Answer
{
    int status;
    std::string type;
    // Further lines of the head, each with its end.
    std::string head;
    std::string body;
};

// Browsers must not guess another type.
inline std::string no_sniffing()
{
    return "X-Content-Type-Options: nosniff\r\n";
}

class LoopbackServer
{
public:
    using Handler = std::function<Answer(const std::string &path)>;

    // Port 0: any free port.
    LoopbackServer(unsigned int port, Handler handler) : handler_(handler)
    {
        if (listen_on(port) && pipe(wake_) == 0) {
            thread_ = std::thread([this] { serve(); });
        } else {
            error_ =
                "cannot listen on 127.0.0.1:" + std::to_string(port) + ": " + std::strerror(errno);
        }
    }

    ~LoopbackServer()
    {
        close_all(wake_[1]); // which wakes the thread
        if (thread_.joinable()) {
            thread_.join();
        }
        close_all(wake_[0]);
        close_all(listener_);
    }
    LoopbackServer(const LoopbackServer &) = delete;
    LoopbackServer &operator=(const LoopbackServer &) = delete;

    // 0 if it does not listen; error() has the reason.
    unsigned int port() const { return port_; }
    const std::string &error() const { return error_; }

private:
    static const int patience_ms = 2000;
    static const std::size_t longest_request = 8192;

    static void close_all(int &descriptor)
    {
        if (descriptor >= 0) {
            close(descriptor);
        }
        descriptor = -1;
    }

    bool listen_on(unsigned int port)
    {
        if (port > 65535) {
            errno = EINVAL;
            return false;
        }
        sockaddr_in address = sockaddr_in();
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        address.sin_port = htons(static_cast<std::uint16_t>(port));
        sockaddr *const generic = reinterpret_cast<sockaddr *>(&address);
        socklen_t length = sizeof address;
        const int yes = 1;
        listener_ = socket(AF_INET, SOCK_STREAM, 0);
        if (listener_ < 0 ||
            setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
            bind(listener_, generic, length) != 0 || listen(listener_, 16) != 0 ||
            getsockname(listener_, generic, &length) != 0) {
            return false;
        }
        port_ = ntohs(address.sin_port);
        return true;
    }

    // Whether the descriptor is readable; false after the timeout, or if the server
    // stops.
    bool await(int descriptor, int milliseconds) const
    {
        pollfd both[2] = {{descriptor, POLLIN, 0}, {wake_[0], POLLIN, 0}};
        const int ready = poll(both, 2, milliseconds);
        return ready > 0 && both[1].revents == 0;
    }

    void serve()
    {
        while (await(listener_, -1)) {
            int client = accept(listener_, nullptr, nullptr);
            if (client >= 0) {
                answer(client);
                close_all(client);
            }
        }
    }

    void answer(int client)
    {
        std::string request;
        char part[1024];
        while (!is_whole(request)) {
            const ssize_t count =
                await(client, patience_ms) ? recv(client, part, sizeof part, 0) : 0;
            if (count <= 0 || request.size() > longest_request) {
                return;
            }
            request.append(part, static_cast<std::size_t>(count));
        }
        const Answer answer = decide(request);
        send_all(client, "HTTP/1.0 " + std::to_string(answer.status) +
                             (answer.status == 200 ? " OK" : " Refused") +
                             "\r\nContent-Type: " + answer.type + "\r\n" + answer.head +
                             "Content-Length: " + std::to_string(answer.body.size()) + "\r\n\r\n" +
                             answer.body);
    }

    // Whether the empty line has arrived; typed requests have lines with \n.
    static bool is_whole(const std::string &request)
    {
        return request.find("\r\n\r\n") != std::string::npos ||
               request.find("\n\n") != std::string::npos;
    }

    Answer decide(const std::string &request) const
    {
        if (request.compare(0, 4, "GET ") != 0) {
            return Answer{405, "text/plain", no_sniffing(), "only GET\n"};
        }
        // A page of another site may resolve its name to this machine (DNS rebinding).
        // Browsers always send the name; programs with HTTP/1.0 need not.
        const std::string host = header(request, "\nhost:");
        const std::string name = host.substr(0, host.find(':'));
        if (!host.empty() && name != "127.0.0.1" && name != "localhost") {
            return Answer{403, "text/plain", no_sniffing(), "only for 127.0.0.1\n"};
        }
        return handler_(request.substr(4, request.find_first_of(" \r\n", 4) - 4));
    }

    static std::string header(std::string request, const std::string &start)
    {
        for (char &letter : request) {
            letter = letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter + 32) : letter;
        }
        const std::size_t at = request.find(start);
        if (at == std::string::npos) {
            return std::string();
        }
        const std::size_t begin = request.find_first_not_of(" \t", at + start.size());
        return begin == std::string::npos
                   ? std::string()
                   : request.substr(begin, request.find_first_of(" \t\r\n", begin) - begin);
    }

    static void send_all(int client, const std::string &text)
    {
        timeval patience = timeval();
        patience.tv_sec = patience_ms / 1000;
        setsockopt(client, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
#if defined(MSG_NOSIGNAL)
        const int flags = MSG_NOSIGNAL;
#else
        const int flags = 0;
#endif
        std::size_t sent = 0;
        while (sent < text.size()) {
            const ssize_t count = ::send(client, text.data() + sent, text.size() - sent, flags);
            if (count <= 0) {
                return;
            }
            sent += static_cast<std::size_t>(count);
        }
    }

    Handler handler_;
    int listener_ = -1;
    int wake_[2] = {-1, -1};
    unsigned int port_ = 0;
    std::string error_;
    std::thread thread_;
};

} // namespace internal
} // namespace robottestingframework

#endif
