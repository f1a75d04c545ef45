"""The host process of Python plug-ins: ``python3 -m rtf.host``.

It implements ``spec/protocol.md`` and runs in the user's ``python3``, so that plug-ins can
import the same modules as the user's shell.
"""
