-- The functions for plug-ins of robot-testing-framework 1.x and 2.x, in
-- `robottestingframework`, `RTF` and `TestCase`.
local rtf = ...

-- Taken before the plug-in can replace it.
local name = rtf.name

local predecessor = {}

-- Only reports the plug-in's own name: the suite's name does not change.
function predecessor.setName(own)
  own = tostring(own)
  if own ~= name() then
    rtf.report("test name: " .. own)
  end
end

function predecessor.testReport(message)
  rtf.report(message)
end

function predecessor.testCheck(condition, message)
  rtf.check(condition, message)
end

-- Despite its name, a failure *unless* the condition holds, as in the predecessor.
function predecessor.testFailIf(condition, message)
  if not condition then
    rtf.check(false, message)
  end
end

-- Also accepts two texts, as the predecessor's `testFailIf` passed them.
function predecessor.testFail(what, message)
  rtf.check(false, message == nil and what or ("%s: %s"):format(tostring(what), tostring(message)))
end

function predecessor.assertError(message)
  rtf.error(message)
end

function predecessor.assertFail(message)
  rtf.fail(message)
end

function predecessor.getEnvironment()
  return rtf.environment()
end

return predecessor
