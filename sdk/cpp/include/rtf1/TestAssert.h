// SPDX-License-Identifier: Apache-2.0
// <TestAssert.h> of RTF 1.x. Its _IF macros mean "unless": the condition is what
// is wanted, and an error or a failure comes when it does not hold.
#ifndef RTF_1_TESTASSERT_H
#define RTF_1_TESTASSERT_H

#include "../robottestingframework/TestAssert.h"

#include "Asserter.h"

#define RTF_SOURCELINE() ROBOTTESTINGFRAMEWORK_SOURCELINE()
#define RTF_SOURCEFILE() ROBOTTESTINGFRAMEWORK_SOURCEFILE()

#define RTF_ASSERT_ERROR_IF(condition, message)                                                    \
    ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_FALSE(condition, message)
#define RTF_ASSERT_FAIL_IF(condition, message)                                                     \
    ROBOTTESTINGFRAMEWORK_ASSERT_FAIL_IF_FALSE(condition, message)
#define RTF_TEST_FAIL_IF(condition, message)                                                       \
    ROBOTTESTINGFRAMEWORK_TEST_FAIL_IF_FALSE(condition, message)

#define RTF_ASSERT_FAIL(message) ROBOTTESTINGFRAMEWORK_ASSERT_FAIL(message)
#define RTF_ASSERT_FAIL_IF_TRUE(condition, message)                                                \
    ROBOTTESTINGFRAMEWORK_ASSERT_FAIL_IF_TRUE(condition, message)
#define RTF_ASSERT_FAIL_IF_FALSE(condition, message)                                               \
    ROBOTTESTINGFRAMEWORK_ASSERT_FAIL_IF_FALSE(condition, message)
#define RTF_ASSERT_ERROR(message) ROBOTTESTINGFRAMEWORK_ASSERT_ERROR(message)
#define RTF_ASSERT_ERROR_IF_TRUE(condition, message)                                               \
    ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_TRUE(condition, message)
#define RTF_ASSERT_ERROR_IF_FALSE(condition, message)                                              \
    ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_FALSE(condition, message)
#define RTF_TEST_REPORT(message) ROBOTTESTINGFRAMEWORK_TEST_REPORT(message)
#define RTF_TEST_CHECK(condition, message) ROBOTTESTINGFRAMEWORK_TEST_CHECK(condition, message)
#define RTF_TEST_FAIL_IF_TRUE(condition, message)                                                  \
    ROBOTTESTINGFRAMEWORK_TEST_FAIL_IF_TRUE(condition, message)
#define RTF_TEST_FAIL_IF_FALSE(condition, message)                                                 \
    ROBOTTESTINGFRAMEWORK_TEST_FAIL_IF_FALSE(condition, message)

#endif
