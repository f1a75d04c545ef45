def test_next_to_doctests():
    """
    >>> 2 * 2
    4
    """
