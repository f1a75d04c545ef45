// SPDX-License-Identifier: Apache-2.0
// The functions of a plug-in's table. They catch all exceptions.
#ifndef RTF_INTERNAL_ENTRY_HPP
#define RTF_INTERNAL_ENTRY_HPP

#include <string_view>
#include <type_traits>

#include <rtf/internal/Exceptions.hpp>

namespace rtf {

class FixtureManager;
class TestCase;
struct Test;

namespace internal {

// Calls a step, and reports its exception as an error.
template <class Step>
int32_t guarded(Step &&step) noexcept
{
    try {
        return step() ? RTF_DONE : RTF_REFUSED;
    } catch (...) {
        report_exception();
    }
    return RTF_STOPPED;
}

// Whether a fixture overrides testStarted or testFinished. A private function is an
// override.
template <class T, class = void>
struct OverridesStarted : std::true_type
{
};

template <class T>
struct OverridesStarted<T, std::void_t<decltype(&T::testStarted)>>
    : std::bool_constant<
          !std::is_same_v<decltype(&T::testStarted), bool (FixtureManager::*)(const Test &)>>
{
};

template <class T, class = void>
struct OverridesFinished : std::true_type
{
};

template <class T>
struct OverridesFinished<T, std::void_t<decltype(&T::testFinished)>>
    : std::bool_constant<!std::is_same_v<decltype(&T::testFinished),
                                         bool (FixtureManager::*)(const Test &, std::string_view,
                                                                  std::string_view)>>
{
};

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

    static void *create(const rtf_host *host)
    {
        current_host.store(host, std::memory_order_release);
        T *made = nullptr;
        guarded([&] {
            made = new T();
            return true;
        });
        return made;
    }

    static void destroy(void *self) { delete &get(self); }

    static int32_t setup(void *self, int argc, char **argv)
    {
        return guarded([&] { return get(self).setup(argc, argv); });
    }

    static int32_t run(void *self)
    {
        return guarded([&] {
            if constexpr (!is_fixture) {
                get(self).run();
            }
            return true;
        });
    }

    static int32_t check(void *self)
    {
        return guarded([&] {
            if constexpr (is_fixture) {
                return get(self).check();
            }
            return true;
        });
    }

    static int32_t test_started(void *self, const rtf_test *test)
    {
        return guarded([&] {
            if constexpr (is_fixture) {
                return get(self).testStarted(
                    Notified{test->id, from_text(test->name), test->repetition, test->attempt});
            }
            return true;
        });
    }

    static int32_t test_finished(void *self, const rtf_test *test)
    {
        return guarded([&] {
            if constexpr (is_fixture) {
                return get(self).testFinished(
                    Notified{test->id, from_text(test->name), test->repetition, test->attempt},
                    from_text(test->verdict), from_text(test->reason));
            }
            return true;
        });
    }

    static int32_t tear_down(void *self)
    {
        return guarded([&] {
            get(self).tearDown();
            return true;
        });
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
    table.kind = Own::is_fixture ? RTF_KIND_FIXTURE : RTF_KIND_TEST;
    table.name = name;
    table.create = Own::create;
    table.destroy = Own::destroy;
    table.setup = Own::setup;
    table.run = Own::is_fixture ? nullptr : Own::run;
    table.check = Own::is_fixture ? Own::check : nullptr;
    table.tear_down = Own::tear_down;
    if constexpr (Own::is_fixture) {
        table.test_started = OverridesStarted<T>::value ? Own::test_started : nullptr;
        table.test_finished = OverridesFinished<T>::value ? Own::test_finished : nullptr;
    }
    return table;
}

} // namespace internal
} // namespace rtf

#endif
