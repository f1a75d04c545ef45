-- A test that does nothing, for rtf and the predecessor.
TestCase = TestCase or {}

function TestCase.setup()
  return true
end

function TestCase.run() end

function TestCase.tearDown() end
