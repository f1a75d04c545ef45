// SPDX-License-Identifier: Apache-2.0
// The functions of a plug-in's table. They catch all exceptions.
#ifndef RTF_INTERNAL_ENTRY_HPP
#define RTF_INTERNAL_ENTRY_HPP

#include <type_traits>

#include <rtf/internal/Exceptions.hpp>

namespace rtf {

class FixtureManager;
class TestCase;
struct Test;

namespace internal {

// Calls a step, and reports its exception as an error. A step without a result succeeds.
template <class Step>
int32_t guarded(Step &&step) noexcept
{
    try {
        if constexpr (std::is_void_v<decltype(step())>) {
            step();
            return RTF_DONE;
        } else {
            return step() ? RTF_DONE : RTF_REFUSED;
        }
    } catch (...) {
        report_exception();
    }
    return RTF_STOPPED;
}

template <class T>
using Started = decltype(&T::testStarted);

template <class T>
using Finished = decltype(&T::testFinished);

// Whether a fixture overrides one of these functions. A private function is an override.
template <template <class> class Function, class T, class = void>
struct Overrides : std::true_type
{
};

template <template <class> class Function, class T>
struct Overrides<Function, T, std::void_t<Function<T>>>
    : std::bool_constant<!std::is_same_v<Function<T>, Function<FixtureManager>>>
{
};

// The functions of the table. Those of the other kind of plug-in are not instantiated.
template <class T>
struct Entry
{
    static constexpr bool is_fixture = std::is_base_of_v<FixtureManager, T>;
    static_assert(is_fixture || std::is_base_of_v<TestCase, T>,
                  "RTF_PLUGIN needs a class that derives from rtf::TestCase or "
                  "rtf::FixtureManager");

    // The functions are public in the base class.
    using Base = std::conditional_t<is_fixture, FixtureManager, TestCase>;

    // Declared only in a fixture's source.
    using Notified = std::conditional_t<is_fixture, Test, void>;

    static Base &get(void *self) { return *static_cast<T *>(self); }

    static Notified notified(const rtf_test &test)
    {
        return {test.id, from_text(test.name), test.repetition, test.attempt};
    }

    static void *create(const rtf_host *host)
    {
        current_host.store(host, std::memory_order_release);
        T *made = nullptr;
        guarded([&] { made = new T(); });
        return made;
    }

    static void destroy(void *self) { delete &get(self); }

    static int32_t setup(void *self, int argc, char **argv)
    {
        return guarded([&] { return get(self).setup(argc, argv); });
    }

    static int32_t run(void *self)
    {
        return guarded([&] { get(self).run(); });
    }

    static int32_t check(void *self)
    {
        return guarded([&] { return get(self).check(); });
    }

    static int32_t test_started(void *self, const rtf_test *test)
    {
        return guarded([&] { return get(self).testStarted(notified(*test)); });
    }

    static int32_t test_finished(void *self, const rtf_test *test)
    {
        return guarded([&] {
            return get(self).testFinished(notified(*test), from_text(test->verdict),
                                          from_text(test->reason));
        });
    }

    static int32_t tear_down(void *self)
    {
        return guarded([&] { get(self).tearDown(); });
    }
};

template <class T>
constexpr rtf_plugin_table table_of(const char *name)
{
    using Own = Entry<T>;
    rtf_plugin_table table{};
    table.abi_major = RTF_ABI_MAJOR;
    table.abi_minor = RTF_ABI_MINOR;
    table.size = sizeof table;
    table.name = name;
    table.create = Own::create;
    table.destroy = Own::destroy;
    table.setup = Own::setup;
    table.tear_down = Own::tear_down;
    if constexpr (Own::is_fixture) {
        table.kind = RTF_KIND_FIXTURE;
        table.check = Own::check;
        table.test_started = Overrides<Started, T>::value ? Own::test_started : nullptr;
        table.test_finished = Overrides<Finished, T>::value ? Own::test_finished : nullptr;
    } else {
        table.kind = RTF_KIND_TEST;
        table.run = Own::run;
    }
    return table;
}

} // namespace internal
} // namespace rtf

#endif
