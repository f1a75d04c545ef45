"""A script that fails, in letters that JSON has to escape."""

import rtf


class Bad(rtf.TestCase):
    """Fails."""

    def run(self) -> None:
        """Fails."""
        self.fail('the "tool\\tip" is 2 µm off: \U0001f916\n')
