def move(joint):
    if joint < 0:
        raise ValueError(joint)
    return joint + 1
