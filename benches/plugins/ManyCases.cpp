// 1000 cases of GoogleTest, each of which takes MICROS microseconds.
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#define CASE(number)                                                                               \
    TEST(Many, Case##number)                                                                       \
    {                                                                                              \
        if (MICROS > 0) {                                                                          \
            std::this_thread::sleep_for(std::chrono::microseconds(MICROS));                        \
        }                                                                                          \
        EXPECT_EQ(number, number);                                                                 \
    }

#include "cases.inc"
