// A library that starts a thread when it is loaded: its programs cannot be forked.

#include <chrono>
#include <thread>

namespace {

struct Watcher
{
    std::thread thread{[] { std::this_thread::sleep_for(std::chrono::hours(1)); }};
    ~Watcher() { thread.detach(); }
};

Watcher watcher;

} // namespace

int watchers()
{
    return watcher.thread.joinable() ? 1 : 0;
}
