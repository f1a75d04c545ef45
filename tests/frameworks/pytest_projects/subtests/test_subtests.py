import unittest

import pytest


def test_all_pass(subtests):
    for joint in range(3):
        with subtests.test("moves", joint=joint):
            assert joint < 3


def test_one_fails(subtests):
    for joint in range(3):
        with subtests.test(joint=joint):
            assert joint != 1


def test_fails_after_subtests(subtests):
    with subtests.test("first"):
        pass
    assert 0


def test_one_is_skipped(subtests):
    with subtests.test("not here"):
        pytest.skip("no arm")


class TestUnittest(unittest.TestCase):
    def test_subtests(self):
        for joint in range(2):
            with self.subTest(joint=joint):
                self.assertNotEqual(joint, 1)
