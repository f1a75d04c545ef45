// SPDX-License-Identifier: Apache-2.0
// The base class of tests and suites.
#ifndef ROBOTTESTINGFRAMEWORK_TEST_H
#define ROBOTTESTINGFRAMEWORK_TEST_H

#include <string>

namespace robottestingframework {

class TestResult;

class Test
{
public:
    Test(std::string name, std::string description = "") : name_(name), description_(description) {}
    virtual ~Test() {}

    const std::string getName() const { return name_; }
    const std::string getDescription() const { return description_; }
    void setDescription(const std::string description) { description_ = description; }

    // Runs it, and adds all events to the result.
    virtual void run(TestResult &result) = 0;

    // Asks it to stop. Called from a different thread than run().
    virtual void interrupt() {}

    // Whether the last run succeeded.
    virtual bool succeeded() const = 0;

protected:
    void setName(std::string name) { name_ = name; }

private:
    std::string name_;
    std::string description_;
};

} // namespace robottestingframework

#endif
