// SPDX-License-Identifier: Apache-2.0
// The events of a collector: one object for each report.
#ifndef ROBOTTESTINGFRAMEWORK_RESULTEVENT_H
#define ROBOTTESTINGFRAMEWORK_RESULTEVENT_H

#include "Test.h"
#include "TestMessage.h"

namespace robottestingframework {

class ResultEvent
{
public:
    ResultEvent() {}
    ResultEvent(const Test *test, TestMessage msg) : test_(test), message_(msg) {}
    virtual ~ResultEvent() = default;

    // The test or suite, which must outlive this event.
    const Test *getTest() { return test_; }
    TestMessage &getMessage() { return message_; }

private:
    const Test *test_ = nullptr;
    TestMessage message_;
};

class ResultEventReport : public ResultEvent
{
public:
    using ResultEvent::ResultEvent;
};

class ResultEventError : public ResultEvent
{
public:
    using ResultEvent::ResultEvent;
};

class ResultEventFailure : public ResultEvent
{
public:
    using ResultEvent::ResultEvent;
};

class ResultEventStartTest : public ResultEvent
{
public:
    using ResultEvent::ResultEvent;
};

class ResultEventEndTest : public ResultEvent
{
public:
    using ResultEvent::ResultEvent;
};

class ResultEventStartSuite : public ResultEvent
{
public:
    using ResultEvent::ResultEvent;
};

class ResultEventEndSuite : public ResultEvent
{
public:
    using ResultEvent::ResultEvent;
};

} // namespace robottestingframework

#endif
