-- Tests the joint of the robot. rtf calls setup, run and tearDown, in a separate process for each test.

local goal, state

-- Reads the position from the stand-in for the robot.
local function position()
  local file = assert(io.open(state))
  local degrees = file:read("n")
  file:close()
  return degrees
end

TestCase = {}

-- Connect here. A problem in setup is an `error`: the bench is wrong, not the robot.
function TestCase.setup(args)
  goal = tonumber(args[1]) -- param in the suite
  state = rtf.fixture_value("simulator.state")
end

-- Test here. The first problem decides the verdict.
function TestCase.run()
  -- Ends the test if it takes longer than 10 s.
  rtf.wait_until(function() return position() >= goal end, 10, "the joint at its goal")
  -- A failed check does not end the test.
  rtf.check_near(position(), goal, 0.5, "joint")
  -- Stored with the result, and checked against the limits.
  rtf.measure("position", position(), "deg", 0, 180)
end

-- Leave the robot as it was. rtf always calls it.
function TestCase.tearDown()
end
