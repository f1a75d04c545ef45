def test_in_a_namespace_package():
    assert __name__
