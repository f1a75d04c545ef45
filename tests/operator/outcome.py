"""A trial whose outcome an operator sees."""

import os

import rtf


class Outcome(rtf.TestCase):
    """Asks for what no sensor measures."""

    def run(self) -> None:
        """Ask for the outcome of the policy, whose name is printed."""
        self.instruct("Put the towel back", timeout=600)
        print("runs", os.environ["RTF_PARAM_POLICY"])
        question = f"Did {os.environ['RTF_PARAM_POLICY']} fold it?"
        self.check(self.ask(question, ["yes", "no"], 600) == "yes", "it is folded")
