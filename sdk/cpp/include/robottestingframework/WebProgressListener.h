// SPDX-License-Identifier: Apache-2.0
// Shows a run in a browser on this machine: http://127.0.0.1:<port>. The page
// polls /events?from=N for new events, in JSON. Clients of robot-testing-framework 2.x
// use /status and /update (spec/web.md).
#ifndef ROBOTTESTINGFRAMEWORK_WEBPROGRESSLISTENER_H
#define ROBOTTESTINGFRAMEWORK_WEBPROGRESSLISTENER_H

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "TestListener.h"
#include "TestSuite.h"
#include "internal/LoopbackServer.h"
#include "internal/WebPage.h"
#include "internal/WebStatus.h"

namespace robottestingframework {

class WebProgressListener : public TestListener
{
public:
    // Port 0: any free port. Verbose: with the source location of each message. If it
    // cannot listen, it prints an error on standard error, and the run continues.
    WebProgressListener(unsigned int port = 8080, bool verbose = false)
        : verbose_(verbose), server_(new internal::LoopbackServer(
                                 port, [this](const std::string &path) { return answer(path); }))
    {
        if (!server_->error().empty()) {
            std::cerr << "error: web page: " << server_->error() << std::endl;
        }
    }
    ~WebProgressListener() override { server_.reset(); }
    WebProgressListener(const WebProgressListener &) = delete;
    WebProgressListener &operator=(const WebProgressListener &) = delete;

    // Its port; 0 if it does not listen.
    unsigned int port() const { return server_->port(); }

    void addReport(const Test *test, TestMessage msg) override
    {
        tell("report", "INFO", test, msg);
    }
    void addError(const Test *test, TestMessage msg) override { tell("error", "ERROR", test, msg); }
    void addFailure(const Test *test, TestMessage msg) override
    {
        tell("failure", "FAIL", test, msg);
    }
    void startTest(const Test *test) override
    {
        const std::string name = test->getName();
        keep("test-started", name, "", [&] { status_.test_started(name); });
    }
    void endTest(const Test *test) override
    {
        const std::string name = test->getName();
        const bool passed = test->succeeded();
        keep("test-ended", name, outcome(passed), [&] { status_.test_ended(name, passed); });
    }
    void startTestSuite(const Test *test) override
    {
        const std::string name = test->getName();
        const TestSuite *const suite = dynamic_cast<const TestSuite *>(test);
        const std::size_t size = suite == nullptr ? 0 : suite->size();
        keep("suite-started", name, "", [&] { status_.suite_started(name, size); });
    }
    void endTestSuite(const Test *test) override
    {
        const std::string name = test->getName();
        const bool passed = test->succeeded();
        keep("suite-ended", name, outcome(passed), [&] { status_.suite_ended(name, passed); });
    }
    void startTestRunner() override { set_running(true); }
    void endTestRunner() override { set_running(false); }

private:
    static const char *outcome(bool passed) { return passed ? "passed" : "failed"; }

    void tell(const char *kind, const char *word, const Test *test, const TestMessage &message)
    {
        std::string text = internal::text_of(message);
        if (verbose_ && !message.getSourceFileName().empty()) {
            text += " (" + message.getSourceFileName() + ":" +
                    std::to_string(message.getSourceLineNumber()) + ")";
        }
        const std::string name = test->getName();
        keep(kind, name, text, [&] { status_.reported(word, name, message); });
    }

    // Updates both views of the events at once.
    template <class Change>
    void keep(const char *kind, const std::string &name, const std::string &text, Change change)
    {
        const std::string json = "{\"kind\":" + internal::json_string(kind) +
                                 ",\"name\":" + internal::json_string(name) +
                                 ",\"text\":" + internal::json_string(text) + "}";
        const std::lock_guard<std::mutex> lock(mutex_);
        events_.push_back(json);
        change();
    }

    void set_running(bool running)
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        running_ = running;
        status_.runner(running);
    }

    internal::Answer answer(const std::string &path)
    {
        const std::string events = "/events";
        if (path == "/") {
            return internal::Answer{200, "text/html; charset=utf-8", internal::no_sniffing(),
                                    internal::web_page()};
        }
        if (path == "/status" || path == "/update") {
            const std::lock_guard<std::mutex> lock(mutex_);
            // Pages of other sites may read them, as those of 2.x.
            return internal::Answer{200, "text/turtle", "Access-Control-Allow-Origin: *\r\n",
                                    path == "/status" ? status_.status() : status_.update()};
        }
        if (path.compare(0, events.size(), events) != 0) {
            return internal::Answer{404, "text/plain", internal::no_sniffing(), "no such page\n"};
        }
        const std::size_t from = path.find("from=");
        const std::size_t first =
            from == std::string::npos
                ? 0
                : std::strtoul(path.c_str() + from + std::strlen("from="), nullptr, 10);
        return internal::Answer{200, "application/json", internal::no_sniffing(), news(first)};
    }

    std::string news(std::size_t first)
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        std::string json = "{\"running\":" + std::string(running_ ? "true" : "false") +
                           ",\"next\":" + std::to_string(events_.size()) + ",\"events\":[";
        for (std::size_t index = first; index < events_.size(); ++index) {
            json += (index == first ? "" : ",") + events_[index];
        }
        return json + "]}";
    }

    bool verbose_;
    std::mutex mutex_; // of what follows
    std::vector<std::string> events_;
    internal::WebStatus status_;
    bool running_ = false;
    // Last member: it may get requests as soon as it exists.
    std::unique_ptr<internal::LoopbackServer> server_;
};

} // namespace robottestingframework

#endif
