import unittest


class TestArm(unittest.TestCase):
    def test_moves(self):
        pass

    def test_fails(self):
        self.assertEqual(1, 2)

    @unittest.skip("no arm")
    def test_skipped(self):
        pass

    @unittest.expectedFailure
    def test_expected(self):
        self.fail("known")

    @unittest.expectedFailure
    def test_unexpected(self):
        pass


class TestBroken(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        raise OSError("not connected")

    def test_never(self):
        pass


class TestLate(unittest.TestCase):
    @classmethod
    def tearDownClass(cls):
        raise OSError("does not stop")

    def test_passes(self):
        pass
