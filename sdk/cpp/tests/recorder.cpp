// SPDX-License-Identifier: Apache-2.0
// A fixture that is notified of each test, and adds to its results.
#include <string>

#include <rtf/FixtureManager.hpp>

class Recorder : public rtf::FixtureManager
{
public:
    bool testStarted(const rtf::Test &test) override { return test.name != "refused"; }

private:
    // Private on purpose: it is called all the same.
    bool testFinished(const rtf::Test &test, std::string_view verdict,
                      std::string_view reason) override
    {
        report(std::to_string(test.id) + " " + test.name + " " + std::to_string(test.repetition) +
               "." + std::to_string(test.attempt) + " " + std::string(verdict) + ": " +
               std::string(reason));
        measure("size", 3.5, "MB");
        attach("/proc/self/status", "run.txt");
        return true;
    }
};

RTF_PLUGIN(Recorder);
