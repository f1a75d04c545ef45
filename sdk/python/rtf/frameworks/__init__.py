"""Reporters for other test frameworks: `spec/frameworks.md`.

The host starts them with the user's interpreter. Without `rtf`, they do nothing.
"""
