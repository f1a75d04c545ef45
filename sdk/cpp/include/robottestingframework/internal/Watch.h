// SPDX-License-Identifier: Apache-2.0
// Calls a test's interrupt() when the runner asks the plug-in to stop.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_WATCH_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_WATCH_H

#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>

#include <rtf/plugin.h>

#include "../TestCase.h"

namespace robottestingframework {
namespace internal {

// Whether T overrides interrupt(). A private or overloaded function is an override.
template <class T, class = void>
struct has_own_interrupt : std::true_type
{
};
template <class T>
struct has_own_interrupt<T, typename std::enable_if<std::is_same<
                                decltype(&T::interrupt), void (TestCase::*)()>::value>::type>
    : std::false_type
{
};

// Waits in a dedicated thread. The host's `wait` returns only on a stop request, so the
// thread is detached, and stop() only takes the test from it.
class Watch
{
public:
    Watch() {}
    ~Watch() { stop(); }
    Watch(const Watch &) = delete;
    Watch &operator=(const Watch &) = delete;

    void start(const rtf_host &host, Test &test)
    {
        shared_ = std::make_shared<Shared>();
        shared_->test = &test;
        const std::shared_ptr<Shared> shared = shared_;
        const rtf_host *const asked = &host;
        std::thread([shared, asked] {
            const double long_enough = 1e9; // seconds: 31 years
            if (asked->wait(asked->context, long_enough) != 0) {
                const std::lock_guard<std::mutex> lock(shared->mutex);
                if (shared->test != nullptr) {
                    shared->test->interrupt();
                }
            }
        }).detach();
    }

    // From now on, the test's interrupt() is not called and does not run.
    void stop()
    {
        if (shared_) {
            const std::lock_guard<std::mutex> lock(shared_->mutex);
            shared_->test = nullptr;
        }
    }

private:
    struct Shared
    {
        std::mutex mutex;
        Test *test = nullptr;
    };

    std::shared_ptr<Shared> shared_;
};

} // namespace internal
} // namespace robottestingframework

#endif
