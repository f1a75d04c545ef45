// Loads a test and prints its name.
#include <iostream>

#include <robottestingframework/dll/DllPluginLoader.h>

int main(int argc, char **argv)
{
    robottestingframework::plugin::DllPluginLoader loader;
    robottestingframework::TestCase *const test = argc == 2 ? loader.open(argv[1]) : nullptr;
    std::cout << (test == nullptr ? loader.getLastError() : test->getName()) << std::endl;
    return test == nullptr ? 1 : 0;
}
