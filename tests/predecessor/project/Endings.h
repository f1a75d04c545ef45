#ifndef BENCH_ENDINGS_H
#define BENCH_ENDINGS_H

#include <string>

#include <robottestingframework/TestCase.h>

// A test that ends in the way of its first argument.
class Endings : public robottestingframework::TestCase
{
public:
    Endings();

    bool setup(int argc, char **argv) override;
    void tearDown() override;
    void run() override;

private:
    void end(const std::string &how);
    void arguments(const std::string &how, int argc, char **argv);

    std::string how;
};

#endif
