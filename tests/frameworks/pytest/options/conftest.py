"""An option with any number of values, as launch_pytest has it."""


def pytest_addoption(parser):
    parser.addoption("--launch-args", nargs="*")
