-- A test that does nothing, for rtf and, by the same names, for the predecessor.
TestCase = TestCase or {}

function TestCase.setup()
  return true
end

function TestCase.run() end

function TestCase.tearDown() end
