-- What plug-ins of robot-testing-framework 1.x and 2.x call: the functions of
-- `robottestingframework`, of `RTF`, and of `TestCase` itself.
local rtf = ...

-- Taken before the plug-in can replace it.
local name = rtf.name

local predecessor = {}

-- The name is the suite's: what the plug-in calls itself is only told.
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

-- The predecessor's sense, whatever the name says: a failure *unless* the
-- condition holds.
function predecessor.testFailIf(condition, message)
  if not condition then
    rtf.check(false, message)
  end
end

-- Two texts, as it was called behind `testFailIf`.
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
