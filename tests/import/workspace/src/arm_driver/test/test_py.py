"""A test that ament_cmake_pytest runs."""


def test_py() -> None:
    """Passes."""
