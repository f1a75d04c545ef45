// SPDX-License-Identifier: Apache-2.0
// A program, not a plug-in: calls the functions of session.hpp that its argument names, and
// prints their results.
#include <clocale>
#include <cstdio>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include <rtf/session.hpp>

namespace {

const double nan_value = std::numeric_limits<double>::quiet_NaN();
const double infinity = std::numeric_limits<double>::infinity();

void print(const char *what, bool result)
{
    std::printf("%s: %s\n", what, result ? "true" : "false");
}

void measure()
{
    std::setlocale(LC_ALL, "de_DE.UTF-8");
    print("free", rtf::measure("free", 1.5));
    print("within", rtf::measure("rate", 0.1, "Hz", 0, 0.1));
    print("below", rtf::measure("rate", -1e-300, "Hz", 0));
    print("above", rtf::measure("rate", 2, "Hz", -infinity, 1));
    print("nan", rtf::measure("rate", nan_value));
    print("infinite", rtf::measure("rate", infinity));
    print("limit", rtf::measure("rate", 1, "Hz", nan_value));
    print("infinite limit", rtf::measure("rate", 1, "Hz", infinity));
    print("long", rtf::measure(std::string(70000, 'x'), 1));
}

void sample()
{
    print("now", rtf::sample("speed", 1, "m/s", 0, 2));
    print("points", rtf::sample("speed", {{0, 1}, {0.5, 3}}, "m/s", 0, 2));
    print("no points", rtf::sample("speed", std::vector<rtf::SamplePoint>()));
    print("many", rtf::sample("speed", std::vector<rtf::SamplePoint>(1000, {-1.5e-200, 0.1})));
}

void texts()
{
    rtf::report(std::string("zero \0 \x1F \"quoted\" back\\slash\n", 29));
    rtf::report("é € 😀 \xC0\xAF|\xED\xA0\x80|\xF5|\xE2\x82");
    rtf::report("");
    rtf::report(std::string(100000, '\x01'));
}

void attach(const char *program)
{
    print("attached", rtf::attach(program, "the program", "application/x-elf"));
    print("own name", rtf::attach(program));
    print("missing", rtf::attach("/nowhere/trace.csv"));
}

void values()
{
    for (const char *name : {"arm.port", "arm.name", "arm.list", "arm.none"}) {
        std::printf("%s: %s\n", name, rtf::fixture_value(name, "otherwise").c_str());
    }
}

void threads()
{
    std::vector<std::thread> threads;
    for (int thread = 0; thread < 8; ++thread) {
        threads.emplace_back([thread] {
            for (int count = 0; count < 100; ++count) {
                rtf::measure("thread " + std::to_string(thread), count);
            }
        });
    }
    for (std::thread &thread : threads) {
        thread.join();
    }
}

void forks()
{
    const pid_t child = fork();
    if (child == 0) {
        print("in the child", rtf::measure("in a child", 1, "", 2));
        rtf::fixture_value("arm.port");
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    print("child", status == 0);
    print("parent", rtf::measure("in the parent", 1));
}

void executes(const char *program)
{
    print("parent", rtf::measure("in the parent", 1));
    if (fork() == 0) {
        execl(program, program, "measure", static_cast<char *>(nullptr));
    }
    int status = 0;
    wait(&status);
}

} // namespace

int main(int argc, char **argv)
{
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const std::string mode = argc > 1 ? argv[1] : "";
    print("rtf", rtf::is_running_in_rtf());
    if (mode == "measure") {
        measure();
    } else if (mode == "sample") {
        sample();
    } else if (mode == "texts") {
        texts();
    } else if (mode == "attach") {
        attach(argv[0]);
    } else if (mode == "values") {
        values();
    } else if (mode == "threads") {
        threads();
    } else if (mode == "forks") {
        forks();
    } else if (mode == "executes") {
        executes(argv[0]);
    }
    return 0;
}
