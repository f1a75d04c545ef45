// Lists two cases as doctest does, but reports something else; the argument says what. Not shared
// with Catch2, so that each file shows the whole report of its framework.

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace {

const char *const list = "<doctest>\n"
                         "<TestCase name=\"moves\"/>\n"
                         "<TestCase name=\"stops\"/>\n"
                         "</doctest>\n";

std::string passed(const std::string &name)
{
    return "<TestCase name=\"" + name +
           "\"><OverallResultsAsserts test_case_success=\"true\"/></TestCase>\n";
}

} // namespace

int main(int argc, char **argv)
{
    std::string file;
    std::string mode;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument.rfind("--out=", 0) == 0) {
            file = argument.substr(6);
        } else if (argument == "--list-test-cases") {
            mode = "list";
        } else if (argument[0] != '-' && mode.empty()) {
            mode = argument;
        }
    }
    std::ofstream out(file);
    const std::string begin = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<doctest>\n";
    const std::string all = begin + passed("moves") + passed("stops");
    const std::string end = "</doctest>\n";
    if (mode == "list") {
        out << list;
    } else if (mode == "garbage") {
        out << "Hello, arm.\n";
    } else if (mode == "other-xml") {
        out << "<robots/>\n";
    } else if (mode == "damaged") {
        out << begin + passed("moves") << "<TestCase name=\"stops\">\n</SubCase>\n" << end;
    } else if (mode == "late") {
        out << all + end << "Hello, arm.\n";
    } else if (mode == "incomplete") {
        out << all;
    } else if (mode == "other-case") {
        out << all + passed("jumps") + end;
    } else if (mode == "exit") {
        out << all + end;
        out.close();
        return 5;
    }
}
