"""An arm.

>>> 1 + 1
2
"""


def move(joint):
    """Move.

    >>> move(1)
    2
    >>> move(2)
    4
    """
    return joint + 1


class Arm:
    """An arm.

    >>> Arm().name  # doctest: +SKIP
    'leg'
    """
