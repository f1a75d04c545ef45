// SPDX-License-Identifier: Apache-2.0
// A test: derive from rtf::TestCase, and write RTF_PLUGIN(Class) once.
#ifndef RTF_TESTCASE_HPP
#define RTF_TESTCASE_HPP

#include <rtf/Declare.hpp>
#include <rtf/Keeper.hpp>

namespace rtf {

class TestCase : public Keeper
{
public:
    // The test. Called when setup succeeded.
    virtual void run() = 0;
};

} // namespace rtf

#endif
