// SPDX-License-Identifier: Apache-2.0
// librtf-cppunit.so: rtf preloads it (LD_PRELOAD) into programs with CppUnit tests, which
// then report their tests without a change of their sources. It replaces the constructor of
// CppUnit::TestResult by one that also adds a listener.
//
// The variable is inherited, so the library is also loaded into programs without CppUnit, for
// example a shell script that starts the tests. It therefore does not link CppUnit, but uses
// the one in the program, if there is one: tools/preload.sh makes its symbols weak.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <set>
#include <string>

#include <dlfcn.h>

#include <rtf/cppunit.hpp>

#include "environment.h"

#define EXPORTED extern "C" __attribute__((visibility("default")))

namespace {

using Synchronization = CppUnit::SynchronizedObject::SynchronizationObject;
using Constructor = void (*)(CppUnit::TestResult *, Synchronization *);

// The results that have a listener, or had one.
std::set<const CppUnit::TestResult *> &results()
{
    static std::set<const CppUnit::TestResult *> results;
    return results;
}

// The program has the library now. What it starts must not load it, too.
void leave_environment()
{
    static const bool is_done = (rtf_restore_environment("librtf-cppunit.so"), true);
    static_cast<void>(is_done);
}

void construct(const char *symbol, CppUnit::TestResult *result, Synchronization *synchronization)
{
    void *const found = dlsym(RTLD_NEXT, symbol);
    if (found == nullptr) {
        std::fprintf(stderr, "rtf: this CppUnit has no %s\n", symbol);
        std::abort();
    }
    Constructor constructor = nullptr;
    std::memcpy(&constructor, &found, sizeof constructor);
    constructor(result, synchronization);
    leave_environment();
    if (rtf::internal::session::is_open()) {
        rtf::internal::session::CppUnitReporter::instance().attach_to(*result);
        results().insert(result);
    }
}

// So that a crash loses no complete line.
__attribute__((constructor)) void buffer_lines()
{
    std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
}

} // namespace

// The constructors, for complete objects and for bases of other classes.
#define RTF_RESULT(kind)                                                                           \
    "_ZN7CppUnit10TestResultC" kind "EPNS_18SynchronizedObject21SynchronizationObjectE"

EXPORTED void rtf_construct_result(CppUnit::TestResult *,
                                   Synchronization *) __asm__(RTF_RESULT("1"));
EXPORTED void rtf_construct_base(CppUnit::TestResult *, Synchronization *) __asm__(RTF_RESULT("2"));

void rtf_construct_result(CppUnit::TestResult *result, Synchronization *synchronization)
{
    construct(RTF_RESULT("1"), result, synchronization);
}

void rtf_construct_base(CppUnit::TestResult *result, Synchronization *synchronization)
{
    construct(RTF_RESULT("2"), result, synchronization);
}

// For session.hpp in the program, see `Exchange`.
EXPORTED char *rtf_session_exchange(const char *packet, std::size_t length,
                                    std::size_t *answer_length)
{
    leave_environment();
    const std::string answer =
        rtf::internal::session::Channel::instance().exchange(std::string(packet, length));
    *answer_length = answer.size();
    char *const copy = static_cast<char *>(std::malloc(answer.size() + 1));
    if (copy != nullptr) {
        std::memcpy(copy, answer.c_str(), answer.size() + 1);
    }
    return copy;
}

// For cppunit.hpp in the program: whether a result has a listener.
EXPORTED int rtf_cppunit_reports(const CppUnit::TestResult *result)
{
    return results().count(result) == 0 ? 0 : 1;
}
