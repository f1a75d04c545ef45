def move(joint):
    """
    >>> move(1)
    2
    """
    return joint + 1
