// Lists two cases as Boost.Test does, but reports something else; the argument says what.

#include <cstdio>
#include <fstream>
#include <string>

namespace {

const char *const list = "digraph G {rankdir=LR;\n"
                         "tu1[color=green,label=\"arm\"];\n{\n"
                         "tu2[color=green,label=\"moves|arm.cpp(3)\"];\ntu1 -> tu2;\n"
                         "tu3[color=green,label=\"stops|arm.cpp(4)\"];\ntu1 -> tu3;\n"
                         "}\n}\n";

} // namespace

int main(int argc, char **argv)
{
    std::string log;
    std::string report;
    std::string mode;
    std::string name;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const auto value = [&](const std::string &option) {
            return argument.rfind(option, 0) == 0 ? argument.substr(option.size()) : "";
        };
        if (argument.rfind("--logger=", 0) == 0) {
            log = value("--logger=XML,test_suite,");
        } else if (argument.rfind("--report_sink=", 0) == 0) {
            report = value("--report_sink=");
        } else if (argument.rfind("--run_test=", 0) == 0) {
            name = value("--run_test=");
        } else if (argument == "--list_content=DOT") {
            std::fputs(list, stderr);
            return 0;
        } else if (argument[0] != '-') {
            mode = argument;
        }
    }
    const std::string test = "<TestSuite name=\"arm\"><TestCase name=\"" + name + "\"";
    const std::string end = "></TestCase></TestSuite>";
    const std::string logged = "<TestLog>" + test + end + "</TestLog>";
    const std::string reported =
        "<TestResult>" + test + " result=\"passed\"" + end + "</TestResult>";
    if (mode == "garbage") {
        std::ofstream(log) << "Hello, arm.\n";
    } else if (mode == "late") {
        std::ofstream(log) << logged << "\nHello, arm.\n";
        std::ofstream(report) << reported;
    } else if (mode == "no-report") {
        std::ofstream(log) << logged;
    } else if (mode == "exit") {
        std::ofstream(log) << logged;
        std::ofstream(report) << reported;
        return 5;
    }
}
