// Lists two cases as Catch2 does, but reports something else; the argument says what.

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace {

const char *const list = "<MatchingTests>\n"
                         "<TestCase><Name>moves</Name></TestCase>\n"
                         "<TestCase><Name>stops</Name></TestCase>\n"
                         "</MatchingTests>\n";

std::string passed(const std::string &name)
{
    return "<TestCase name=\"" + name + "\"><OverallResult success=\"true\"/></TestCase>\n";
}

} // namespace

int main(int argc, char **argv)
{
    std::string file;
    std::string mode;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument.rfind("xml::out=", 0) == 0) {
            file = argument.substr(9);
        } else if (argument == "--list-tests") {
            mode = "list";
        } else if (argument[0] != '-' && mode.empty()) {
            mode = argument;
        }
    }
    std::ofstream out(file);
    const std::string begin = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Catch2TestRun>\n";
    const std::string all = begin + passed("moves") + passed("stops");
    const std::string end = "</Catch2TestRun>\n";
    if (mode == "list") {
        out << list;
    } else if (mode == "garbage") {
        out << "Hello, arm.\n";
    } else if (mode == "other-xml") {
        out << "<robots/>\n";
    } else if (mode == "damaged") {
        out << begin + passed("moves") << "<TestCase name=\"stops\">\n</Section>\n" << end;
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
    } else if (mode == "skip-code") {
        out << all + end;
        out.close();
        return 4;
    }
}
