"""The host process of Python plug-ins: ``python3 -m rtf.host``.

It speaks the protocol of ``spec/protocol.md`` and runs in the interpreter that
the user calls ``python3``, so that what can be imported in their shell can be
imported in their plug-ins.
"""
