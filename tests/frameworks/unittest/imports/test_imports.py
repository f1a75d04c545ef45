"""A module that cannot be imported."""

import no_such_module_of_the_arm  # noqa: F401
