// SPDX-License-Identifier: Apache-2.0
// Stores and counts all reports of a run.
#ifndef ROBOTTESTINGFRAMEWORK_TESTRESULTCOLLECTOR_H
#define ROBOTTESTINGFRAMEWORK_TESTRESULTCOLLECTOR_H

#include <set>
#include <vector>

#include "ResultEvent.h"
#include "TestListener.h"

namespace robottestingframework {

class TestResultCollector : public TestListener
{
public:
    typedef std::vector<ResultEvent *> EventResultContainer;
    typedef std::vector<ResultEvent *>::iterator EventResultIterator;

    TestResultCollector() {}
    ~TestResultCollector() override { reset(); }
    TestResultCollector(const TestResultCollector &) = delete;
    TestResultCollector &operator=(const TestResultCollector &) = delete;

    // Removes everything.
    void reset()
    {
        for (ResultEvent *event : events_) {
            delete event;
        }
        events_.clear();
        problems_.clear();
        tests_ = Counts();
        suites_ = Counts();
    }

    // The tests that have started; each has passed or failed at its end.
    unsigned int testCount() { return tests_.begun; }
    unsigned int failedCount() { return tests_.failed; }
    unsigned int passedCount() { return tests_.passed; }
    unsigned int suiteCount() { return suites_.begun; }
    unsigned int failedSuiteCount() { return suites_.failed; }
    unsigned int passedSuiteCount() { return suites_.passed; }

    // In the order of events; owned by the collector.
    EventResultContainer &getResults() { return events_; }

    void addReport(const Test *test, TestMessage msg) override
    {
        keep<ResultEventReport>(test, msg);
    }
    void addError(const Test *test, TestMessage msg) override
    {
        problems_.insert(test);
        keep<ResultEventError>(test, msg);
    }
    void addFailure(const Test *test, TestMessage msg) override
    {
        problems_.insert(test);
        keep<ResultEventFailure>(test, msg);
    }
    void startTest(const Test *test) override
    {
        begin(tests_, test);
        keep<ResultEventStartTest>(test, TestMessage());
    }
    void endTest(const Test *test) override
    {
        keep<ResultEventEndTest>(test, outcome(tests_, test));
    }
    void startTestSuite(const Test *test) override
    {
        begin(suites_, test);
        keep<ResultEventStartSuite>(test, TestMessage());
    }
    void endTestSuite(const Test *test) override
    {
        keep<ResultEventEndSuite>(test, outcome(suites_, test));
    }

private:
    struct Counts
    {
        unsigned int begun = 0;
        unsigned int passed = 0;
        unsigned int failed = 0;
    };

    template <class Event>
    void keep(const Test *test, const TestMessage &message)
    {
        events_.push_back(new Event(test, message));
    }

    void begin(Counts &counts, const Test *test)
    {
        problems_.erase(test);
        ++counts.begun;
    }

    TestMessage outcome(Counts &counts, const Test *test)
    {
        if (test->succeeded() && problems_.count(test) == 0) {
            ++counts.passed;
            return TestMessage("passed");
        }
        ++counts.failed;
        return TestMessage("failed");
    }

    EventResultContainer events_;
    // The tests and suites with an error or a failure.
    std::set<const Test *> problems_;
    Counts tests_;
    Counts suites_;
};

} // namespace robottestingframework

#endif
